//! The presets: estimators learnt as a user's are, from damaged random scenes.

use anyhow::{Context, Result};
use faer::Mat;
use phalanx::{Estimator, Preset, Progress, SceneDescriber, Scenes, Shard, Workspace, targets};
use phalanx_hand::{Dof, Pose};
use phalanx_segmentation::Silhouette;
use rayon::prelude::*;

use super::Ground;
use super::errors::Truth;
use super::row::{Outcome, Row};
use crate::sets::{Augment, Set, random};
use crate::table1::single_view;

/// A preset learnt from some of the cameras.
pub(crate) struct Learnt {
    preset: Preset,
    samples: usize,
    /// The cameras' numbers in the whole rig.
    views: Vec<usize>,
    pub(crate) estimator: Estimator,
    /// What guessing without looking says.
    mean: Pose,
}

/// The name in tables and JSON.
pub(crate) fn name(preset: Preset) -> &'static str {
    match preset {
        Preset::Fast => "fast",
        Preset::Balanced => "preset",
        Preset::Best => "best",
    }
}

/// Learns presets through one view (the top), two next to each other and all.
pub(crate) fn learn(
    presets: &[Preset],
    ground: &Ground,
    progress: &dyn Progress,
) -> Result<Vec<Learnt>> {
    let work = presets
        .iter()
        .flat_map(|&preset| views(ground).into_iter().map(move |views| (preset, views)));
    work.map(|(preset, views)| Learnt::new(preset, views, ground, progress)).collect()
}

fn views(ground: &Ground) -> Vec<Vec<usize>> {
    let all = ground.rig.cameras.len();
    let single = single_view(&ground.rig).unwrap_or(0);
    let mut views = vec![vec![single], (0..all.min(2)).collect(), (0..all).collect()];
    views.dedup();
    views
}

impl Learnt {
    fn new(
        preset: Preset,
        views: Vec<usize>,
        ground: &Ground,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let names: Vec<&str> =
            views.iter().map(|&view| ground.rig.cameras[view].name.as_str()).collect();
        let rig = ground.rig.select(&names)?;
        let set = random(&rig, &ground.hand, preset.scenes(), Augment::Yes);
        let training = preset.training();
        let part = training.shard(&rig, &ground.hand, &set, Shard::WHOLE, progress)?;
        let samples = set.count() - part.left_out();
        progress.begin("fit the regressor", 1);
        let estimator = part.finish()?;
        progress.step();
        let mean = Dof::ALL.map(|dof| {
            set.poses.iter().map(|pose| pose[dof]).sum::<f64>() / set.poses.len() as f64
        });
        Ok(Self { preset, samples, views, estimator, mean: Pose(mean) })
    }

    fn estimate(&self, silhouettes: &[Silhouette], workspace: &mut Workspace) -> Result<Pose> {
        let seen: Vec<Silhouette> =
            self.views.iter().map(|&view| silhouettes[view].clone()).collect();
        Ok(self.estimator.estimate_silhouettes(&seen, workspace)?.pose)
    }

    fn row(
        &self,
        test: &'static str,
        estimates: &[Pose],
        truth: &Truth,
        ground: &Ground,
    ) -> Result<Row> {
        let (estimates, guess) = (targets(estimates), targets(&[self.mean]));
        let guesses = Mat::from_fn(guess.nrows(), estimates.ncols(), |dof, _| guess[(dof, 0)]);
        let outcome = Outcome {
            train: "random_augmented",
            train_samples: self.samples,
            method: name(self.preset),
            views: self.views.len(),
            kept_samples: self.estimator.regression().kept_samples(),
        };
        outcome.row(test, estimates.as_ref(), guesses.as_ref(), truth, ground)
    }
}

/// Every learnt preset on one test set.
pub(crate) fn test(
    set: &Set<'_>,
    learnt: &[Learnt],
    ground: &Ground,
    progress: &dyn Progress,
) -> Result<Vec<Row>> {
    let describer = SceneDescriber::new(&ground.rig, ground.rule)?;
    progress.begin(&format!("see {}", set.name), set.count());
    let estimates = |(describer, workspace): &mut (SceneDescriber, Workspace), number: usize| {
        let scene = set.scene(number);
        let seen = describer.silhouettes(&scene).ok().map(|seen| seen.cloned().collect());
        progress.step();
        let seen: Vec<Silhouette> = seen?;
        let each = learnt.iter().map(|learnt| learnt.estimate(&seen, workspace));
        Some((scene, each.collect::<Result<Vec<_>>>().ok()?))
    };
    let memory = || (describer.clone(), Workspace::default());
    let estimated: Vec<_> =
        (0..set.count()).into_par_iter().map_init(memory, estimates).flatten().collect();
    if estimated.len() < set.count() {
        let (left_out, all) = (set.count() - estimated.len(), set.count());
        eprintln!("{}: {left_out} of {all} cannot be estimated by every preset", set.name);
    }
    let truth = Truth::of(estimated.iter().map(|(scene, _)| scene.clone()), ground);
    rows(set.name, learnt, estimated.into_iter().map(|(_, each)| each), &truth, ground)
}

/// The rows of estimates, of each sample one by every preset.
pub(crate) fn rows(
    test: &'static str,
    learnt: &[Learnt],
    estimates: impl Iterator<Item = Vec<Pose>>,
    truth: &Truth,
    ground: &Ground,
) -> Result<Vec<Row>> {
    let estimates: Vec<Vec<Pose>> = estimates.collect();
    let of = |(number, learnt): (usize, &Learnt)| {
        let own: Vec<Pose> = estimates.iter().map(|each| each[number]).collect();
        learnt.row(test, &own, truth, ground).with_context(|| name(learnt.preset))
    };
    learnt.iter().enumerate().map(of).collect()
}
