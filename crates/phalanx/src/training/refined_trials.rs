//! Learning how refined estimates err: drawn scenes are estimated, refined and compared with the truth.

use phalanx_hand::Dof;
use phalanx_refine::PoseFitSettings;
use rayon::prelude::*;

use crate::error::Result;
use crate::estimator::answering::Workspace;
use crate::estimator::model::Estimator;
use crate::estimator::refined_errors::{RefinedErrors, RefinedTrial};
use crate::losses::Losses;
use crate::progress::Progress;
use crate::refiner::{RefinedFits, Refiner};
use crate::synthesis::augmentation::Augmentation;
use crate::synthesis::sampler::SceneSampler;
use crate::synthesis::scene::{Scene, SceneSource};
use crate::synthesis::scene_describer::SceneDescriber;
use crate::view_set::ViewSet;

/// One of so many scenes is of the hand and the rig as they are given: errors there are less wild, so that fewer
/// scenes tell them.
const AS_GIVEN: usize = 4;

impl Estimator {
    /// Learns how its refined estimates err, from scenes of a sampler that it was not trained on. One in four
    /// is of the hand and the rig as they are given, so that both what they explain and what they do not is
    /// tried; each is seen by some of the cameras that it answers from, as many views as often as any.
    ///
    /// # Errors
    /// A camera that cannot draw. Scenes that cannot be refined are left out, and said to `progress`.
    pub fn fit_refined_errors(
        self,
        sampler: &SceneSampler,
        count: usize,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let as_given = SceneSampler { augmentation: Augmentation::NONE, ..sampler.clone() };
        let scenes = |sampler| SceneSampler::scenes(sampler, self.rig(), self.hand(), count);
        let (given, others) = (scenes(&as_given), scenes(sampler));
        let views = self.tried_views();
        let refiner = Refiner::for_estimator(&self, PoseFitSettings::of_strangers())?;
        let describer = SceneDescriber::new(self.rig(), self.descriptor().view_config())?;
        progress.begin("learn how refined estimates err", count);
        let tried = |(describer, workspace): &mut (SceneDescriber, Workspace), number: usize| {
            let (round, place) = (number / AS_GIVEN, number % AS_GIVEN);
            let scene = if place == 0 { given.scene(number) } else { others.scene(number) };
            let subset = chosen(&views, round + place);
            let tried = self.refined_trial(&refiner, &scene, subset, (describer, workspace));
            progress.step();
            tried
        };
        let memory = || (describer.clone(), Workspace::default());
        let tried: Vec<Result<RefinedTrial>> =
            (0..count).into_par_iter().map_init(memory, tried).collect();
        let (mut trials, mut losses) = (Vec::with_capacity(count), Losses::default());
        for (number, tried) in tried.into_iter().enumerate() {
            match tried {
                Ok(trial) => trials.push(trial),
                Err(error) => losses.add(number, &error),
            }
        }
        if losses.count() > 0 {
            progress.lost(&losses, count);
        }
        self.with_refined_errors(RefinedErrors::learn(&trials))
    }

    /// The sets of cameras that it answers from, by how many they are.
    fn tried_views(&self) -> Vec<Vec<ViewSet>> {
        let cameras = self.rig().cameras.len();
        let mut sets = match self.subsets() {
            Some(_) => ViewSet::learnt(cameras),
            None => Vec::new(),
        };
        sets.push(ViewSet::of(0..cameras));
        sets.sort_by_key(|set| set.count());
        sets.chunk_by(|a, b| a.count() == b.count()).map(<[ViewSet]>::to_vec).collect()
    }

    fn refined_trial(
        &self,
        refiner: &Refiner,
        scene: &Scene,
        cameras: ViewSet,
        (describer, workspace): (&mut SceneDescriber, &mut Workspace),
    ) -> Result<RefinedTrial> {
        let observation = describer.observation(scene)?.seen_by(cameras);
        let estimate = self.estimate_observation(observation, workspace)?;
        let RefinedFits { best: fit, deviations, .. } = refiner.fits(self, &estimate)?;
        let error = |dof: Dof| (fit.pose[dof] - scene.pose[dof]).abs();
        Ok(RefinedTrial {
            views: cameras.count(),
            is_doubted: fit.nuisance.is_some(),
            errors: Dof::ALL.map(error),
            deviations,
        })
    }
}

/// One set after the other of each size in turn.
fn chosen(sizes: &[Vec<ViewSet>], number: usize) -> ViewSet {
    let sets = &sizes[number % sizes.len()];
    sets[number / sizes.len() % sets.len()]
}
