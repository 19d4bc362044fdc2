//! How estimates err, learnt from scenes that the estimator was not trained on.

use faer::Mat;
use phalanx_hand::{Dof, Pose, Unit};
use phalanx_rvm::ResidualKde;
use rayon::prelude::*;

use crate::checking::usual::{Explanation, UsualExplanation};
use crate::error::{Error, Result};
use crate::estimator::estimate::{Estimate, Estimator, Workspace, known};
use crate::estimator::placement::{PLACED, PlacementErrors};
use crate::losses::Losses;
use crate::progress::Progress;
use crate::synthesis::scene::SceneSource;
use crate::synthesis::scene_describer::SceneDescriber;
use crate::training::recipe::targets;
use crate::window::Framing;

/// Scenes with estimates near to one that say how such an estimate errs.
const NEIGHBOURS: usize = 200;
/// Scenes that say which explanations are usual: enough for some of them to be beyond each view's share
/// of those that are doubted.
const EXPLAINED: usize = 1500;
/// Millimetres of a wrist's offset that count as much as a radian of an angle: about what a radian
/// at the knuckle moves the fingertip.
const MM_PER_RADIAN: f64 = 80.0;

/// How an estimator errs.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorModel {
    /// The errors of what regression tells.
    pub residuals: ResidualKde,
    /// How well its answers explain what was seen.
    pub usual: UsualExplanation,
    /// The errors of what windows tell, if the estimator looks through windows.
    pub placement: Option<PlacementErrors>,
}

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

/// An estimate of a scene whose pose is known.
struct Trial {
    truth: Pose,
    estimate: Pose,
    /// Of the first scenes.
    explanation: Option<Explanation>,
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
        let trials = self.trials(scenes, progress)?;
        let explained: Vec<Explanation> =
            trials.iter().filter_map(|trial| trial.explanation.clone()).collect();
        let pairs: Vec<(Pose, Pose)> =
            trials.iter().map(|trial| (trial.estimate, trial.truth)).collect();
        let errors = ErrorModel {
            residuals: self.residuals(&pairs)?,
            usual: UsualExplanation::learn(&explained),
            placement: match self.framing() {
                Framing::Picture => None,
                Framing::Window => Some(PlacementErrors::learn(&pairs)),
            },
        };
        self.with_error_model(errors)
    }

    /// An estimate of every scene that all cameras show, of which there is at least one.
    fn trials(&self, scenes: &dyn SceneSource, progress: &dyn Progress) -> Result<Vec<Trial>> {
        progress.begin("learn how estimates err", scenes.count());
        let describer = SceneDescriber::new(self.rig(), self.descriptor().view_config())?;
        let trial = |(describer, workspace): &mut (SceneDescriber, Workspace), number: usize| {
            let scene = scenes.scene(number);
            let estimate = describer
                .observation(&scene)
                .and_then(|observation| self.estimate_observation(observation, workspace));
            progress.step();
            let estimate = estimate?;
            let explanation = (number < EXPLAINED)
                .then(|| self.explanation(self.hand(), &estimate))
                .transpose()?;
            Ok(Trial { truth: scene.pose, estimate: estimate.pose, explanation })
        };
        let memory = || (describer.clone(), Workspace::default());
        let tried: Vec<Result<Trial>> =
            (0..scenes.count()).into_par_iter().map_init(memory, trial).collect();
        let (mut trials, mut losses) = (Vec::with_capacity(tried.len()), Losses::default());
        for (number, tried) in tried.into_iter().enumerate() {
            match tried {
                Ok(trial) => trials.push(trial),
                Err(error) => losses.add(number, &error),
            }
        }
        losses.check(scenes.count())?;
        if trials.is_empty() {
            return Err(Error::TooFewPoses { found: 0 });
        }
        Ok(trials)
    }

    /// How what regression tells errs, from estimates and the truth of each.
    fn residuals(&self, pairs: &[(Pose, Pose)]) -> Result<ResidualKde> {
        let unplaced = |pose: fn(&(Pose, Pose)) -> &Pose| -> Mat<f64> {
            let poses: Vec<Pose> = pairs.iter().map(|pair| self.unplaced(pose(pair))).collect();
            targets(&poses)
        };
        let (estimates, truth) = (unplaced(|pair| &pair.0), unplaced(|pair| &pair.1));
        let units = Dof::ALL.map(|dof| match dof.unit() {
            Unit::Angle => 1.0,
            Unit::Length => MM_PER_RADIAN,
        });
        let neighbours = NEIGHBOURS.min(pairs.len());
        Ok(ResidualKde::fit(estimates.as_ref(), truth.as_ref(), &units, neighbours)?)
    }

    /// At most `most` poses that may be behind an estimate, the estimate's own first and the others
    /// by falling weight.
    ///
    /// # Errors
    /// An estimator that has not [learnt how it errs](Self::fit_error_model), or no or too many
    /// hypotheses asked for.
    pub fn hypotheses(&self, estimate: &Estimate, most: usize) -> Result<Vec<Hypothesis>> {
        let errors = self.error_model().ok_or(Error::NoErrorModel)?;
        let found = errors.residuals.hypotheses(&self.unplaced(&estimate.pose).0, most)?;
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
