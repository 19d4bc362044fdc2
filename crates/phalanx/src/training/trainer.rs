//! Training by a preset, from scenes to an estimator that knows how it errs.

use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};

use crate::error::Result;
use crate::estimator::model::Estimator;
use crate::progress::Progress;
use crate::synthesis::augmentation::Augmentation;
use crate::synthesis::sampler::{PoseSource, SceneSampler};
use crate::training::cameras::Cameras;
use crate::training::partial::{ErrorScenes, PartialTraining};
use crate::training::preset::Preset;
use crate::training::recipe::Training;
use crate::training::shard::Shard;
use crate::window::Framing;

/// Trains an estimator as a [`Preset`] says: draws random scenes, learns from them, and fits a model of
/// the estimator's errors to further scenes.
///
/// ```no_run
/// use phalanx::{NoProgress, Preset, Trainer};
/// use phalanx_camera::Rig;
/// use phalanx_hand::HandShape;
///
/// let rig = Rig::from_toml(&std::fs::read_to_string("rig.toml")?)?;
/// let estimator = Trainer::preset(Preset::Default).fit(&rig, &HandShape::adult(), &NoProgress)?;
/// std::fs::write("hand.phalanx", estimator.to_bytes()?)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Trainer {
    training: Training,
    poses: Option<PoseSource>,
    augmentation: Augmentation,
    samples: usize,
    error_samples: usize,
    seed: u32,
}

/// What a training takes, roughly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cost {
    /// Scenes that are drawn through every camera, those of the error model included.
    pub scenes: usize,
    /// Bytes that are held at most.
    pub bytes: usize,
}

impl Trainer {
    /// Scenes that the error model is fitted to.
    pub const ERROR_SAMPLES: usize = 4000;

    /// For so many scenes that are learnt from one is refined, of strangers or of the hand as given, to learn how
    /// refined estimates err. It takes as long as to learn from some 25.
    const PER_REFINED: usize = 80;

    /// There are at least so many that the error model is fitted to for one that is refined: 160 are refined at most,
    /// unless it is fitted to more than [`ERROR_SAMPLES`](Self::ERROR_SAMPLES).
    const ERROR_SAMPLES_PER_REFINED: usize = 25;

    /// As a preset says: whole pictures, random poses with every [`Augmentation`], an error model.
    pub fn preset(preset: Preset) -> Self {
        Self::new(preset.training(), preset.scenes())
    }

    /// By a recipe of one's own, from so many random scenes.
    pub fn new(training: Training, samples: usize) -> Self {
        Self {
            training,
            poses: None,
            augmentation: Augmentation::default(),
            samples,
            error_samples: Self::ERROR_SAMPLES,
            seed: 0,
        }
    }

    /// What of the pictures is looked at. [`Framing::Window`] learns from hands anywhere in the rig's
    /// volume.
    #[must_use]
    pub fn framing(mut self, framing: Framing) -> Self {
        self.training.framing = framing;
        self
    }

    /// Which cameras it answers from: any of the rig's by default.
    #[must_use]
    pub fn answers_from(mut self, cameras: Cameras) -> Self {
        self.training.answers_from = cameras;
        self
    }

    /// How many scenes are learnt from.
    #[must_use]
    pub fn samples(mut self, samples: usize) -> Self {
        self.samples = samples;
        self
    }

    /// How many further scenes the error model is fitted to; 0 for none, and then the estimator has no
    /// hypotheses. The fewer they are, the fewer scenes are refined to learn how refined estimates err.
    #[must_use]
    pub fn error_samples(mut self, samples: usize) -> Self {
        self.error_samples = samples;
        self
    }

    /// Where poses come from; by default what goes with the framing.
    #[must_use]
    pub fn poses(mut self, poses: PoseSource) -> Self {
        self.poses = Some(poses);
        self
    }

    /// Learns from recorded poses in place of the prior's.
    #[must_use]
    pub fn recorded(self, poses: Vec<Pose>) -> Self {
        self.poses(PoseSource::Recorded(poses))
    }

    /// How scenes differ from what the rig is made for.
    #[must_use]
    pub fn augmentation(mut self, augmentation: Augmentation) -> Self {
        self.augmentation = augmentation;
        self
    }

    /// The seed of all that is drawn; 0 by default.
    #[must_use]
    pub fn seed(mut self, seed: u32) -> Self {
        self.seed = seed;
        self
    }

    /// The recipe that the scenes are learnt by.
    pub fn training(&self) -> &Training {
        &self.training
    }

    /// The scenes that are learnt from.
    pub fn sampler(&self) -> SceneSampler {
        let framing = self.training.framing;
        let poses = self.poses.clone().unwrap_or_else(|| PoseSource::for_framing(framing));
        let sampler = SceneSampler::new(poses).with_seed(self.seed);
        SceneSampler { augmentation: self.augmentation.clone(), ..sampler }
    }

    /// How many scenes are refined.
    fn refined_samples(&self) -> usize {
        let most = self.error_samples / Self::ERROR_SAMPLES_PER_REFINED;
        (self.samples / Self::PER_REFINED).min(most)
    }

    /// What training through so many views takes in one run.
    pub fn cost(&self, views: usize, shard: Shard) -> Cost {
        let own = shard.scenes(self.samples);
        let pilot = self.samples.min(self.training.regressor.pilot());
        let codebook = self.samples.min(Training::CODEBOOK_SCENES);
        let errors = match (shard, self.error_samples) {
            (Shard::WHOLE, 1..) => self.error_samples + self.refined_samples(),
            _ => 0,
        };
        Cost {
            scenes: codebook.saturating_add(pilot).saturating_add(own).saturating_add(errors),
            bytes: self.training.bytes(views, codebook, pilot, own),
        }
    }

    /// Trains for a rig and a hand. The same input gives the same estimator at any number of threads.
    ///
    /// # Errors
    /// An unusable rig or hand, fewer than two scenes, or more than [`Losses::MOST`](crate::Losses::MOST)
    /// of the scenes that some camera does not show.
    pub fn fit(&self, rig: &Rig, hand: &HandShape, progress: &dyn Progress) -> Result<Estimator> {
        self.fit_shard(rig, hand, Shard::WHOLE, progress)?.finish(progress)
    }

    /// Does one shard of the training. All shards, [merged](PartialTraining::merge) in any order and
    /// [finished](PartialTraining::finish), give the bytes of [`fit`](Self::fit).
    ///
    /// # Errors
    /// As of [`fit`](Self::fit).
    pub fn fit_shard(
        &self,
        rig: &Rig,
        hand: &HandShape,
        shard: Shard,
        progress: &dyn Progress,
    ) -> Result<PartialTraining> {
        self.resume_shard(rig, hand, shard, None, &mut |_| {}, progress)
    }

    /// Does one shard of the training from where an earlier run of it was broken off. `keep` is shown the
    /// part after every block of scenes, to keep it for such a case; the result has the bytes of an
    /// unbroken run.
    ///
    /// # Errors
    /// As of [`fit`](Self::fit), and an earlier part of another training or shard.
    pub fn resume_shard(
        &self,
        rig: &Rig,
        hand: &HandShape,
        shard: Shard,
        earlier: Option<PartialTraining>,
        keep: &mut dyn FnMut(&PartialTraining),
        progress: &dyn Progress,
    ) -> Result<PartialTraining> {
        let sampler = self.sampler();
        sampler.check()?;
        let scenes = sampler.scenes(rig, hand, self.samples);
        let errors = ErrorScenes {
            sampler: sampler.fresh(),
            count: self.error_samples,
            refined: self.refined_samples(),
        };
        let begun = self.training.begin(rig, hand, &scenes, progress)?;
        let begun = begun.with_error_scenes((self.error_samples > 0).then_some(errors));
        let mut part = match earlier {
            Some(earlier) => begun.with_seen(earlier, shard)?,
            None => begun,
        };
        part.add_shard(&scenes, shard, keep, progress)?;
        Ok(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Peaks of the program and of `cargo xtask presets`, MiB, through three views.
    #[test]
    fn the_memory_that_is_said_is_about_what_was_measured() {
        let part = Shard::new(1, 100).unwrap();
        for (preset, shard, measured) in [
            (Preset::Fast, Shard::WHOLE, 384.0),
            (Preset::Default, Shard::WHOLE, 879.0),
            (Preset::Best, Shard::WHOLE, 1657.0),
            (Preset::Default, part, 368.0),
        ] {
            let bytes = Trainer::preset(preset).cost(3, shard).bytes;
            let ratio = bytes as f64 / f64::from(1 << 20) / measured;
            assert!((0.9..1.3).contains(&ratio), "{preset:?}, {shard:?}: {ratio:.2} of it");
        }
    }
}
