//! What every part of a training begins with.

use faer::{Mat, MatRef};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape};
use phalanx_rvm::{BasisSpec, PilotSample, random_subset};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::features::descriptor::{Descriptor, describe_scenes};
use crate::features::samples::targets;
use crate::losses::Losses;
use crate::progress::Progress;
use crate::synthesis::scene::SUBSET_SEED;
use crate::synthesis::scene::{SceneSource, SceneSubset};
use crate::synthesis::scene_describer::describe_each;
use crate::training::cameras::Cameras;
use crate::training::feature_transform::FeatureTransform;
use crate::training::recipe::Training;
use crate::training::regressor::{Kept, RegressorConfig, columns_of};

/// What every part of a training must know before it begins; each finds it by itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct TrainingPlan {
    pub(crate) rig: Rig,
    pub(crate) hand: HandShape,
    pub(crate) descriptor: Descriptor,
    pub(crate) regressor: RegressorConfig,
    pub(crate) answers_from: Cameras,
    pub(crate) transform: FeatureTransform,
    /// Scenes that scaling and Gaussian centres are taken from, and their x (as the regressor reads
    /// it) and y (28), one after the other.
    pub(crate) pilot: Vec<usize>,
    pub(crate) pilot_x: Vec<f64>,
    pilot_y: Vec<f64>,
}

impl Training {
    pub(crate) fn plan(
        &self,
        rig: &Rig,
        hand: &HandShape,
        scenes: &dyn SceneSource,
        progress: &dyn Progress,
    ) -> Result<TrainingPlan> {
        self.regressor.check_samples(scenes.count(), self.least_dim(rig.cameras.len()))?;
        let some = SceneSubset::new(scenes, Training::CODEBOOK_SCENES);
        let described = describe_each(rig, &some, self.view_config(), progress)?;
        let (mut contexts, mut losses) = (Vec::with_capacity(described.len()), Losses::default());
        for (place, described) in described.into_iter().enumerate() {
            match described {
                Ok(described) => contexts.push(described),
                Err(error) => losses.add(some.number(place), &error),
            }
        }
        losses.check(some.count())?;
        if contexts.len() < 2 {
            return Err(Error::TooFewPoses { found: contexts.len() });
        }
        progress.begin("cluster shape contexts", 1);
        let descriptor = self.descriptor(&contexts)?;
        drop(contexts);
        progress.step();
        let pilot = random_subset(scenes.count(), self.regressor.pilot(), SUBSET_SEED);
        progress.begin("render and describe", pilot.len());
        let described = describe_scenes(rig, scenes, &pilot, &descriptor, progress)?;
        // These scenes come again, and are counted then.
        let (pilot, x) = described_ones(&pilot, described, &mut Losses::default());
        let y = targets_of(scenes, &pilot);
        let transform = self.regressor.transform(&x, &y, &descriptor, progress)?;
        let chosen = random_subset(pilot.len(), self.regressor.centres(), SUBSET_SEED);
        let [x, y] = [x, y].map(|all| columns_of(all.as_ref(), &chosen));
        let x = transform.of(x)?;
        let numbers = |all: &Mat<f64>| all.col_iter().flat_map(|c| c.iter().copied()).collect();
        Ok(TrainingPlan {
            rig: rig.clone(),
            hand: hand.clone(),
            descriptor,
            regressor: self.regressor.clone(),
            answers_from: self.answers_from,
            transform,
            pilot_x: numbers(&x),
            pilot_y: numbers(&y),
            pilot: chosen.into_iter().map(|place| pilot[place]).collect(),
        })
    }
}

impl TrainingPlan {
    /// Numbers that the regressor reads of a scene.
    pub(crate) fn read(&self) -> usize {
        self.transform.count(self.descriptor.dim())
    }

    /// The columns of all numbers of the pose together, or of each group; none of a regressor that is
    /// fitted to the samples themselves.
    pub(crate) fn columns(&self) -> Result<Vec<BasisSpec>> {
        let samples = self.pilot.len();
        let length = |each: usize| each.saturating_mul(samples);
        for (part, found, expected) in [
            ("numbers of pilot descriptors", self.pilot_x.len(), length(self.read())),
            ("numbers of pilot poses", self.pilot_y.len(), length(Dof::COUNT)),
        ] {
            if found != expected {
                return Err(Error::Mismatch { part, found, expected });
            }
        }
        let x = MatRef::from_column_major_slice(&self.pilot_x, self.read(), samples);
        let y = MatRef::from_column_major_slice(&self.pilot_y, Dof::COUNT, samples);
        match (&self.regressor, &self.transform) {
            (RegressorConfig::Network(_), FeatureTransform::Components(_)) => Ok(Vec::new()),
            (regressor, FeatureTransform::Whole) if regressor.kept() != Kept::Sums => {
                Ok(Vec::new())
            }
            (RegressorConfig::LearntMetric(fitter), FeatureTransform::Metric { metric, .. }) => {
                let of_group = |group: usize| {
                    let y = metric.targets(group, y);
                    let x = metric.part(group, x);
                    let pilot = PilotSample { x, y: y.as_ref(), samples: &self.pilot };
                    Ok(BasisSpec::in_proportion(&pilot, fitter.regression.bandwidth)?)
                };
                (0..metric.groups.len()).into_par_iter().map(of_group).collect()
            }
            (regressor, transform) => match (regressor.summed(), transform) {
                (Some(kernel), FeatureTransform::Whole) => {
                    let pilot = PilotSample { x, y, samples: &self.pilot };
                    Ok(vec![BasisSpec::new(&pilot, kernel)?])
                }
                _ => Err(Error::FileContent {
                    what: "training part",
                    reason: "what it reads is not what its regressor reads".to_owned(),
                }),
            },
        }
    }
}

/// Which scenes could be described, and their descriptors; the others are lost.
pub(crate) fn described_ones(
    numbers: &[usize],
    described: Vec<Result<Vec<f64>>>,
    losses: &mut Losses,
) -> (Vec<usize>, Mat<f64>) {
    let mut kept: Vec<(usize, Vec<f64>)> = Vec::with_capacity(numbers.len());
    for (&number, described) in numbers.iter().zip(described) {
        match described {
            Ok(x) => kept.push((number, x)),
            Err(error) => losses.add(number, &error),
        }
    }
    let dim = kept.first().map_or(0, |(_, x)| x.len());
    let x = Mat::from_fn(dim, kept.len(), |row, i| kept[i].1[row]);
    (kept.into_iter().map(|(number, _)| number).collect(), x)
}

pub(crate) fn targets_of(scenes: &dyn SceneSource, numbers: &[usize]) -> Mat<f64> {
    let poses: Vec<_> = numbers.iter().map(|&number| scenes.scene(number).pose).collect();
    targets(&poses)
}
