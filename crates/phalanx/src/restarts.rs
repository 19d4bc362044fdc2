//! Refining several hypotheses, and naming the poses that stand for all that came out.

use phalanx_hand::{Dof, Pose, Unit};
use phalanx_refine::{PoseFit, PoseFitSettings, SilhouetteObservation};

use crate::error::Result;
use crate::estimator::estimate::Estimate;
use crate::estimator::hypotheses::Hypothesis;
use crate::fit_chances;
use crate::refiner::Refiner;

/// Least spread of a hypothesis in refinement, as a share of the estimate's standard deviation: a
/// hypothesis that few errors stand behind is not thereby certain.
const LEAST_SPREAD: f64 = 0.25;

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
    let chance = |refined: &PoseFit| fit_chances::chance(refined.energy - least);
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

/// Sum of the differences of two poses' angles, radians.
fn difference(one: &Pose, other: &Pose) -> f64 {
    let angles = Dof::ALL.into_iter().filter(|dof| dof.unit() == Unit::Angle);
    angles.map(|dof| (one[dof] - other[dof]).abs()).sum()
}
