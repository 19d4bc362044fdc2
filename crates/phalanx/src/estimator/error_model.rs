//! Several poses for one picture: what the silhouettes leave open.

use faer::Mat;
use phalanx_hand::{Dof, Pose, Unit};
use phalanx_rvm::ResidualKde;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::estimator::estimate::{Estimate, Estimator, known};
use crate::features::descriptor::describe_scenes;
use crate::global_pose::PLACED;
use crate::losses::Losses;
use crate::progress::Progress;
use crate::synthesis::scene::SceneSource;
use crate::training::recipe::targets;
use crate::window::Framing;

/// Scenes with estimates near to one that say how such an estimate errs.
const NEIGHBOURS: usize = 200;
/// Millimetres of a wrist's offset that count as much as a radian of an angle: about what a radian
/// at the knuckle moves the fingertip.
const MM_PER_RADIAN: f64 = 80.0;

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
    pub fn fit_error_model(
        self,
        scenes: &dyn SceneSource,
        progress: &dyn Progress,
    ) -> Result<Self> {
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
            self.regressor().predict_into(x, &mut scratch, &mut pose.0, &mut std)?;
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
        self.with_error_model(ResidualKde::fit(estimates, truth, &units, neighbours)?)
    }

    /// At most `most` poses that may be behind an estimate, the estimate's own first and the others
    /// by falling weight.
    ///
    /// # Errors
    /// An estimator that has not [learnt how it errs](Self::fit_error_model), or no or too many
    /// hypotheses asked for.
    pub fn hypotheses(&self, estimate: &Estimate, most: usize) -> Result<Vec<Hypothesis>> {
        let errors = self.error_model().ok_or(Error::NoErrorModel)?;
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
