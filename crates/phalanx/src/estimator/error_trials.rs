//! How estimates err, learnt from scenes that the estimator was not trained on.

use faer::Mat;
use phalanx_hand::{Dof, Pose, Unit};
use phalanx_rvm::ResidualKde;
use rayon::prelude::*;

use crate::checking::usual::{Explanation, UsualExplanation};
use crate::error::{Error, Result};
use crate::estimator::answering::Workspace;
use crate::estimator::error_model::ErrorModel;
use crate::estimator::model::Estimator;
use crate::estimator::observation::Observation;
use crate::estimator::placement::{PlacementErrors, unplaced};
use crate::features::samples::targets;
use crate::losses::Losses;
use crate::progress::Progress;
use crate::synthesis::scene::SceneSource;
use crate::synthesis::scene_describer::SceneDescriber;
use crate::view_set::ViewSet;
use crate::window::Framing;

/// Scenes with estimates near to one that say how such an estimate errs.
const NEIGHBOURS: usize = 200;
/// Scenes that say which explanations are usual: enough for some of them to be beyond each view's share
/// of those that are doubted.
const EXPLAINED: usize = 1500;
/// Scenes that say how answers from each subset of the cameras err. A quarter of them are neighbours: fewer
/// views tell less of how they err.
const OF_SUBSETS: usize = 4 * NEIGHBOURS;
/// Of so many scenes each says which explanations are usual from every subset; later ones from one in turn.
const BY_ALL: usize = 8;
/// Millimetres of a wrist's offset that count as much as a radian of an angle: about what a radian
/// at the knuckle moves the fingertip.
const MM_PER_RADIAN: f64 = 80.0;

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
        let errors = trials.iter().map(|trials| self.errors(trials)).collect::<Result<Vec<_>>>()?;
        let mut errors = errors.into_iter();
        let of_all = errors.next().ok_or(Error::TooFewPoses { found: 0 })?;
        self.with_error_model(of_all)?.with_subset_errors(errors.collect())
    }

    /// How estimates err, from some whose truth is known.
    fn errors(&self, trials: &[Trial]) -> Result<ErrorModel> {
        let explained: Vec<Explanation> =
            trials.iter().filter_map(|trial| trial.explanation.clone()).collect();
        if explained.is_empty() {
            return Err(Error::TooFewPoses { found: 0 });
        }
        let pairs: Vec<(Pose, Pose)> =
            trials.iter().map(|trial| (trial.estimate, trial.truth)).collect();
        Ok(ErrorModel {
            residuals: self.residuals(&pairs)?,
            usual: UsualExplanation::learn(&explained),
            placement: match self.framing() {
                Framing::Picture => None,
                Framing::Window => Some(PlacementErrors::learn(&pairs)),
            },
        })
    }

    /// Estimates of scenes that all cameras show, of which there is at least one: from all cameras, and
    /// from each learnt subset of them.
    fn trials(&self, scenes: &dyn SceneSource, progress: &dyn Progress) -> Result<Vec<Vec<Trial>>> {
        progress.begin("learn how estimates err", scenes.count());
        let describer = SceneDescriber::new(self.rig(), self.descriptor().view_config())?;
        let tried = |(describer, workspace): &mut (SceneDescriber, Workspace), number: usize| {
            let scene = scenes.scene(number);
            let tried = describer
                .observation(&scene)
                .and_then(|observation| self.tried(number, scene.pose, observation, workspace));
            progress.step();
            tried
        };
        let memory = || (describer.clone(), Workspace::default());
        let tried: Vec<Result<Vec<Trial>>> =
            (0..scenes.count()).into_par_iter().map_init(memory, tried).collect();
        let (mut trials, mut losses) = (Vec::<Vec<Trial>>::new(), Losses::default());
        for (number, tried) in tried.into_iter().enumerate() {
            match tried {
                Ok(tried) => {
                    trials.resize_with(trials.len().max(tried.len()), Vec::new);
                    trials.iter_mut().zip(tried).for_each(|(all, trial)| all.push(trial));
                }
                Err(error) => losses.add(number, &error),
            }
        }
        losses.check(scenes.count())?;
        Ok(trials)
    }

    /// The estimate of a scene from all cameras and, of the first scenes, from each learnt subset of them.
    fn tried(
        &self,
        number: usize,
        truth: Pose,
        observation: Observation,
        workspace: &mut Workspace,
    ) -> Result<Vec<Trial>> {
        self.describe(&observation, workspace)?;
        let subsets = match self.subsets() {
            Some(_) if number < OF_SUBSETS => ViewSet::learnt(self.rig().cameras.len()),
            _ => Vec::new(),
        };
        let mut trials = Vec::with_capacity(1 + subsets.len());
        for (place, &subset) in subsets.iter().enumerate() {
            let is_explained = number < BY_ALL || number % subsets.len() == place;
            let seen = observation.seen_by(subset);
            trials.push(self.trial(truth, seen, is_explained, workspace)?);
        }
        trials.insert(0, self.trial(truth, observation, number < EXPLAINED, workspace)?);
        Ok(trials)
    }

    /// The estimate from what is described in the workspace.
    fn trial(
        &self,
        truth: Pose,
        observation: Observation,
        is_explained: bool,
        workspace: &mut Workspace,
    ) -> Result<Trial> {
        let expert = self.expert(&observation)?;
        let mut estimate = self.answer(expert, observation, workspace)?;
        let mut explanation = None;
        if is_explained {
            estimate.overlaps = self.overlaps(self.hand(), &estimate)?;
            explanation = Some(self.explanation(self.hand(), &estimate)?);
        }
        Ok(Trial { truth, estimate: estimate.pose, explanation })
    }

    /// How what regression tells errs, from estimates and the truth of each.
    fn residuals(&self, pairs: &[(Pose, Pose)]) -> Result<ResidualKde> {
        let unplaced = |pose: fn(&(Pose, Pose)) -> &Pose| -> Mat<f64> {
            let poses: Vec<Pose> =
                pairs.iter().map(|pair| unplaced(pose(pair), self.framing())).collect();
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
}
