//! What other postures of single digits leave open of a fitted pose.

use glam::DAffine3;
use phalanx_hand::{Digit, Dof, HandShape, Pose};

use crate::error::Result;
use crate::observation::silhouette::SilhouetteObservation;
use crate::pose_fit::fit::PoseFit;
use crate::pose_fit::settings::PoseFitSettings;
use crate::posture_search::Search;
use crate::priors::pose::PosePrior;

/// A posture is e times less likely than another for so much more that speaks against it, most of it pixels in which
/// silhouettes differ: pixels beside each other err together. Of values from 1 to 20 it is the one by which the errors of
/// refined drawn hands are most likely, of strange hands and of those as given, before one, two and three cameras.
const TOLD_APART: f64 = 5.0;

/// Postures that are this near to the fit's are the same, radians: the curvature of the energy tells of them.
const SAME: f64 = 0.15;

impl PoseFitSettings {
    /// What it adds to the variances of a fit that digits in other postures explain the silhouettes about as well, as where
    /// a finger is hidden behind others: the mean squared distance of each number from the fit's, over the postures of each
    /// digit alone, weighted by how likely they are beside the fit. In radians² and mm²; 0 of numbers of the whole hand.
    ///
    /// # Errors
    /// As of [`fit`](Self::fit).
    pub fn posture_variance(
        &self,
        hand: &HandShape,
        rest: &DAffine3,
        evidence: &[SilhouetteObservation],
        fit: &PoseFit,
        prior: &PosePrior,
    ) -> Result<[f64; Dof::COUNT]> {
        let as_given = vec![DAffine3::IDENTITY; evidence.len()];
        let (hand, motions) = match &fit.nuisance {
            Some(fitted) => (&fitted.hand, &fitted.motions),
            None => (hand, &as_given),
        };
        let views = &mut self.matchers(evidence)?;
        let mut search = Search { hand, rest, evidence, prior, motions, views };
        let mut variances = [0.0; Dof::COUNT];
        for digit in Digit::ALL {
            let others = search.alternatives(digit, &fit.pose)?;
            for (dof, variance) in digit.dofs().into_iter().zip(spread(&fit.pose, digit, &others)) {
                variances[dof.index()] = variance;
            }
        }
        Ok(variances)
    }
}

/// The mean squared distances of a digit's numbers from those of a pose, over that and some others, against each of which
/// so much more speaks.
fn spread(pose: &Pose, digit: Digit, others: &[(Pose, f64)]) -> [f64; 4] {
    let dofs = digit.dofs();
    let (mut sums, mut weights) = ([0.0; 4], 1.0);
    for (other, more) in others {
        let apart = dofs.map(|dof| other[dof] - pose[dof]);
        if apart.iter().all(|apart| apart.abs() <= SAME) {
            continue;
        }
        // A search by pixels may find a posture that is better by its own count, and no worse than as likely by that of
        // the fit.
        let weight = (-more.max(0.0) / TOLD_APART).exp();
        weights += weight;
        sums.iter_mut().zip(apart).for_each(|(sum, apart)| *sum += weight * apart * apart);
    }
    sums.map(|sum| sum / weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bent(angle: f64) -> Pose {
        let mut pose = Pose::REST;
        pose[Digit::Ring.dofs()[1]] = angle;
        pose
    }

    #[test]
    fn a_posture_that_is_as_likely_counts_half() {
        let [abduction, base, ..] = spread(&Pose::REST, Digit::Ring, &[(bent(0.8), 0.0)]);
        assert_eq!(abduction, 0.0);
        assert!((base - 0.32).abs() < 1e-12, "{base}");
    }

    #[test]
    fn what_is_unlikely_or_the_same_adds_little() {
        let others = [(bent(1.0), 20.0 * TOLD_APART), (bent(0.1), 0.0)];
        let [_, base, ..] = spread(&Pose::REST, Digit::Ring, &others);
        assert!(base < 1e-8, "{base}");
        assert_eq!(spread(&Pose::REST, Digit::Ring, &[]), [0.0; 4]);
    }
}
