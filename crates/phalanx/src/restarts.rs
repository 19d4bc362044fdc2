//! Refining several hypotheses, and naming the poses that stand for all that came out.

use phalanx_hand::{Dof, Pose, Unit};
use phalanx_refine::{PoseFit, PoseFitSettings, SilhouetteObservation};

use crate::error::Result;
use crate::estimator::estimate::Estimate;
use crate::estimator::hypotheses::Hypothesis;
use crate::refiner::Refiner;

/// Least spread of a hypothesis in refinement, as a share of the estimate's standard deviation: a
/// hypothesis that few errors stand behind is not thereby certain.
const LEAST_SPREAD: f64 = 0.25;

/// How many times too much an energy says of how likely a pose is: places of a border that are beside
/// each other err together.
const OVERSTATED: f64 = 3.0;

impl Refiner {
    /// Poses that are named at most where several are possible.
    pub const POSES: usize = 5;

    /// How many hypotheses about an estimate from so many views are worth refining: one view leaves so much
    /// open that more starts lead to poses which explain it better.
    pub fn starts(views: usize) -> usize {
        if views == 1 { 2 * Self::POSES } else { Self::POSES }
    }

    /// Refines every hypothesis about an estimate, each with what it says of itself as the prior, and
    /// names at most [`POSES`](Self::POSES) poses that stand for all that came out; the one to be
    /// believed first.
    ///
    /// They are those of which the nearest is least far from a pose drawn by how well each
    /// [explains](PoseFit::energy) the silhouettes. Hand and cameras are doubted, if at all, in these.
    ///
    /// # Errors
    /// As of [`refine`](Self::refine).
    pub fn refine_hypotheses(
        &self,
        evidence: &[SilhouetteObservation],
        estimate: &Estimate,
        hypotheses: &[Hypothesis],
    ) -> Result<Vec<PoseFit>> {
        let refine = |refiner: &Self, hypothesis: &Hypothesis| {
            let spread = |dof: usize| {
                let least = LEAST_SPREAD * estimate.std[dof]?;
                Some(hypothesis.std[dof].map_or(least, |std| std.max(least)))
            };
            let std = std::array::from_fn(spread);
            refiner.refine(evidence, &Estimate { pose: hypothesis.pose, std, ..estimate.clone() })
        };
        let certain =
            self.with_refinement(PoseFitSettings { nuisance: None, ..self.refinement().clone() });
        let all = hypotheses.iter().map(|hypothesis| refine(&certain, hypothesis));
        let all = all.collect::<Result<Vec<_>>>()?;
        let beyond =
            self.refinement().nuisance.map_or(f64::INFINITY, |nuisance| nuisance.above_rms_px);
        let doubted = |&k: &usize| match &all[k] {
            refined if refined.boundary_rms_px > beyond => refine(self, &hypotheses[k]),
            refined => Ok(refined.clone()),
        };
        let some = representatives(&all).iter().map(doubted).collect::<Result<Vec<_>>>()?;
        Ok(representatives(&some).iter().map(|&k| some[k].clone()).collect())
    }
}

/// The numbers of those refined poses that stand for all, the one that does so best first.
fn representatives(refined: &[PoseFit]) -> Vec<usize> {
    let least = refined.iter().map(|refined| refined.energy).fold(f64::INFINITY, f64::min);
    let chance = |refined: &PoseFit| ((least - refined.energy) / OVERSTATED).exp();
    let mut apart = vec![f64::INFINITY; refined.len()];
    let mut chosen = Vec::new();
    while chosen.len() < Refiner::POSES.min(refined.len()) {
        let nearer = |k: usize| -> Vec<f64> {
            let to_it = refined.iter().map(|other| difference(&refined[k].pose, &other.pose));
            apart.iter().zip(to_it).map(|(apart, to_it)| apart.min(to_it)).collect()
        };
        let expected = |k: usize| -> f64 {
            refined.iter().zip(nearer(k)).map(|(refined, apart)| chance(refined) * apart).sum()
        };
        let left = (0..refined.len()).filter(|k| !chosen.contains(k));
        let costs: Vec<(f64, usize)> = left.map(|k| (expected(k), k)).collect();
        let Some(&(_, next)) = costs.iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        apart = nearer(next);
        chosen.push(next);
    }
    chosen
}

/// The mean squared distance of each number from a fit's, over that and some other fits, weighted by how well each
/// explains the silhouettes.
pub(crate) fn variance_by_others(best: &PoseFit, others: &[PoseFit]) -> [f64; Dof::COUNT] {
    let chance = |other: &PoseFit| ((best.energy - other.energy).min(0.0) / OVERSTATED).exp();
    let chances: Vec<f64> = others.iter().map(chance).collect();
    let all = 1.0 + chances.iter().sum::<f64>();
    Dof::ALL.map(|dof| {
        let apart = others.iter().map(|other| (other.pose[dof] - best.pose[dof]).powi(2));
        apart.zip(&chances).map(|(apart, chance)| chance * apart).sum::<f64>() / all
    })
}

/// Sum of the differences of two poses' angles, radians.
fn difference(one: &Pose, other: &Pose) -> f64 {
    let angles = Dof::ALL.into_iter().filter(|dof| dof.unit() == Unit::Angle);
    angles.map(|dof| (one[dof] - other[dof]).abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(angle: f64, energy: f64) -> PoseFit {
        let mut pose = Pose::REST;
        pose[Dof::IndexPip] = angle;
        PoseFit {
            pose,
            energy,
            covariance: Vec::new(),
            ious: Vec::new(),
            unexplained: Vec::new(),
            landmarks_unexplained: Vec::new(),
            boundary_rms_px: 0.0,
            nuisance: None,
            converged: true,
            steps: 0,
        }
    }

    /// One that explains as much counts half, and so does one that explains more, since the first is the one to be
    /// believed; what explains much less does not count.
    #[test]
    fn other_fits_count_as_they_explain() {
        let best = fit(0.2, 10.0);
        for (energy, least, most) in [(10.0, 0.499, 0.501), (2.0, 0.499, 0.501), (80.0, 0.0, 1e-9)]
        {
            let variances = variance_by_others(&best, &[fit(1.2, energy)]);
            let variance = variances[Dof::IndexPip.index()];
            assert!((least..=most).contains(&variance), "{energy}: {variance}");
            assert_eq!(variances[Dof::RingPip.index()], 0.0);
        }
        assert_eq!(variance_by_others(&best, &[]), [0.0; Dof::COUNT]);
    }
}
