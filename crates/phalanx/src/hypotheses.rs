//! Several poses for one picture: what the silhouettes leave open.

use faer::Mat;
use phalanx_hand::{Dof, Pose, Unit};
use phalanx_refine::{Evidence, Refined, Refinement};
use phalanx_rvm::ResidualKde;
use rayon::prelude::*;

use crate::estimator::known;
use crate::global_pose::PLACED;
use crate::{
    Error, Estimate, Estimator, Framing, Losses, Progress, Refiner, Result, Scenes,
    describe_scenes, targets,
};

/// Scenes with estimates near to one that say how such an estimate errs.
const NEIGHBOURS: usize = 200;
/// Millimetres of a wrist's offset that count as much as a radian of an angle: about what a radian
/// at the knuckle moves the fingertip.
const MM_PER_RADIAN: f64 = 80.0;

/// Least spread of a hypothesis in refinement, as a share of the estimate's standard deviation: a
/// hypothesis that few errors stand behind is not thereby certain.
const LEAST_SPREAD: f64 = 0.25;

/// How many times too much an energy says of how likely a pose is: places of a border that are beside
/// each other err together.
const OVERSTATED: f64 = 3.0;

/// One pose among several that a hand may have.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypothesis {
    /// The pose, radians and millimetres.
    pub pose: Pose,
    /// How far poses that this one stands for stray from it, root mean square of each number, in
    /// its unit; `None` for a number that is not estimated.
    pub std: [Option<f64>; Dof::COUNT],
    /// The probability that the truth is nearer to this pose than to the other hypotheses.
    pub weight: f64,
}

impl Estimator {
    /// Learns how its estimates err, from scenes that it was not trained on: some thousands of
    /// independent ones from the prior of the training.
    ///
    /// # Errors
    /// A camera that cannot draw; no scene, or more than [`Losses::MOST`] that cannot be described.
    pub fn learn_errors(self, scenes: &dyn Scenes, progress: &dyn Progress) -> Result<Self> {
        progress.begin("learn what is left open", scenes.count());
        let all: Vec<usize> = (0..scenes.count()).collect();
        let described = describe_scenes(self.rig(), scenes, &all, self.descriptor(), progress)?;
        let (mut numbers, mut descriptors) = (Vec::new(), Vec::new());
        let mut losses = Losses::default();
        for (number, described) in described.into_iter().enumerate() {
            match described {
                Ok(x) => {
                    numbers.push(number);
                    descriptors.push(x);
                }
                Err(error) => losses.add(number, &error),
            }
        }
        losses.check(scenes.count())?;
        if numbers.is_empty() {
            return Err(Error::TooFewPoses { found: 0 });
        }
        let predict = |x: &Vec<f64>| {
            let (mut pose, mut std) = (Pose::REST, [0.0; Dof::COUNT]);
            let mut scratch = phalanx_rvm::Scratch::default();
            self.regression().predict_into(x, &mut scratch, &mut pose.0, &mut std)?;
            Ok(pose)
        };
        let estimates = descriptors.par_iter().map(predict).collect::<Result<Vec<_>>>()?;
        let estimates: Vec<Pose> = estimates.iter().map(|pose| self.unplaced(pose)).collect();
        let truth = numbers.iter().map(|&number| self.unplaced(&scenes.scene(number).pose));
        let truth: Vec<Pose> = truth.collect();
        let (estimates, truth): (Mat<f64>, Mat<f64>) = (targets(&estimates), targets(&truth));
        let neighbours = NEIGHBOURS.min(numbers.len());
        let units = Dof::ALL.map(|dof| match dof.unit() {
            Unit::Angle => 1.0,
            Unit::Length => MM_PER_RADIAN,
        });
        let (estimates, truth) = (estimates.as_ref(), truth.as_ref());
        self.with_errors(ResidualKde::fit(estimates, truth, &units, neighbours)?)
    }

    /// At most `most` poses that may be behind an estimate, the estimate's own first and the others
    /// by falling weight.
    ///
    /// # Errors
    /// An estimator that has not [learnt how it errs](Self::learn_errors), or no or too many
    /// hypotheses asked for.
    pub fn hypotheses(&self, estimate: &Estimate, most: usize) -> Result<Vec<Hypothesis>> {
        let errors = self.errors().ok_or(Error::NoErrors)?;
        let found = errors.hypotheses(&self.unplaced(&estimate.pose).0, most)?;
        let hypothesis = |found: &phalanx_rvm::Hypothesis| {
            let learnt = |dof: usize| estimate.std[dof].and(known(found.std[dof]));
            let mut hypothesis = Hypothesis {
                pose: Pose(std::array::from_fn(|dof| found.mean[dof])),
                std: std::array::from_fn(learnt),
                weight: found.weight,
            };
            for &dof in self.placed() {
                hypothesis.pose[dof] = estimate.pose[dof];
                hypothesis.std[dof.index()] = estimate.std[dof.index()];
            }
            hypothesis
        };
        Ok(found.iter().map(hypothesis).collect())
    }

    /// The numbers that windows tell where they are looked through, and regression does not.
    fn placed(&self) -> &'static [Dof] {
        match self.framing() {
            Framing::Picture => &[],
            Framing::Window => &PLACED,
        }
    }

    /// A pose without what windows tell.
    fn unplaced(&self, pose: &Pose) -> Pose {
        let mut pose = *pose;
        for &dof in self.placed() {
            pose[dof] = Pose::REST[dof];
        }
        pose
    }
}

impl Refiner {
    /// Poses that are named at most where several are possible.
    pub const POSES: usize = 5;

    /// How many hypotheses about an estimate are worth refining: one view leaves so much open that more
    /// starts lead to poses which explain it better.
    pub fn starts(&self) -> usize {
        if self.views() == 1 { 2 * Self::POSES } else { Self::POSES }
    }

    /// Refines every hypothesis about an estimate, each with what it says of itself as the prior, and
    /// names at most [`POSES`](Self::POSES) poses that stand for all that came out; the one to be
    /// believed first.
    ///
    /// They are those of which the nearest is least far from a pose drawn by how well each
    /// [explains](Refined::energy) the silhouettes. Hand and cameras are doubted, if at all, in these.
    ///
    /// # Errors
    /// As of [`refine`](Self::refine).
    pub fn refine_hypotheses(
        &self,
        evidence: &[Evidence],
        estimate: &Estimate,
        hypotheses: &[Hypothesis],
    ) -> Result<Vec<Refined>> {
        let refine = |refiner: &Self, hypothesis: &Hypothesis| {
            let spread = |dof: usize| {
                let least = LEAST_SPREAD * estimate.std[dof]?;
                Some(hypothesis.std[dof].map_or(least, |std| std.max(least)))
            };
            let std = std::array::from_fn(spread);
            refiner.refine(evidence, &Estimate { pose: hypothesis.pose, std, ..estimate.clone() })
        };
        let certain = self.with_refinement(Refinement { doubt: None, ..self.refinement().clone() });
        let all = hypotheses.iter().map(|hypothesis| refine(&certain, hypothesis));
        let all = all.collect::<Result<Vec<_>>>()?;
        let beyond = self.refinement().doubt.map_or(f64::INFINITY, |doubt| doubt.beyond);
        let doubted = |&k: &usize| match &all[k] {
            refined if refined.border_px > beyond => refine(self, &hypotheses[k]),
            refined => Ok(refined.clone()),
        };
        let some = representatives(&all).iter().map(doubted).collect::<Result<Vec<_>>>()?;
        Ok(representatives(&some).iter().map(|&k| some[k].clone()).collect())
    }
}

/// The numbers of those refined poses that stand for all, the one that does so best first.
fn representatives(refined: &[Refined]) -> Vec<usize> {
    let least = refined.iter().map(|refined| refined.energy).fold(f64::INFINITY, f64::min);
    let chance = |refined: &Refined| ((least - refined.energy) / OVERSTATED).exp();
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
