//! Training on any number of scenes that stream by, all at once or in parts.

use std::collections::BTreeMap;

use phalanx_camera::Rig;
use phalanx_hand::HandShape;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::estimator::model::Estimator;
use crate::features::descriptor::describe_scenes;
use crate::losses::Losses;
use crate::progress::Progress;
use crate::synthesis::sampler::SceneSampler;
use crate::synthesis::scene::SceneSource;
use crate::training::maker::Maker;
use crate::training::plan::{TrainingPlan, described_ones, targets_of};
use crate::training::recipe::Training;
use crate::training::samples::Samples;
use crate::training::shard::{BLOCK, Shard, scenes_of};
use crate::training::statistics::TrainingStatistics;

/// What one [`Shard`] of a training has seen: enough to be [merged](Self::merge) with the others'
/// and to [`finish`](Self::finish) the estimator. For most regressors that is sums, whose size does
/// not depend on the number of scenes; a [network](crate::RegressorConfig::Network) keeps what it reads of
/// each, a dense regressor the descriptor of each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartialTraining {
    pub(super) plan: TrainingPlan,
    pub(super) scenes: usize,
    /// The blocks that are in the sums, ascending, and the scenes that could not be described.
    pub(super) blocks: Vec<usize>,
    pub(super) losses: Losses,
    pub(super) statistics: TrainingStatistics,
    /// Components of some blocks of scenes, which the kernels of subsets of the cameras are fitted to.
    pub(super) components: BTreeMap<usize, Samples<f32>>,
    /// What the error model is fitted to, if there is to be one.
    pub(super) errors: Option<ErrorScenes>,
    /// What made it, ascending.
    makers: Vec<Maker>,
}

/// Scenes that an error model is fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct ErrorScenes {
    pub(crate) sampler: SceneSampler,
    pub(crate) count: usize,
    /// How many of another draw are refined.
    pub(crate) refined: usize,
}

impl Training {
    /// Learns from scenes of a rig, of which there may be any number: none is kept. Scenes that some
    /// camera does not show well enough are left out; [`PartialTraining::losses`] tells how many, and why.
    ///
    /// A run does the `shard` of all blocks of scenes that it is told; runs that differ in nothing
    /// else give parts which, merged in any order, [finish](PartialTraining::finish) to the bytes of a single
    /// run of [`Shard::WHOLE`].
    ///
    /// The codebooks are learnt from at most a thousand scenes, chosen at random, and the regressor
    /// has a [limited number](crate::RegressorConfig::CANDIDATES) of Gaussians. `rig` and `hand` are what
    /// the estimator takes pictures to be of, whatever the scenes are.
    ///
    /// # Errors
    /// An unusable rig or hand, fewer than two scenes that can be described, more than
    /// [`Losses::MOST`] that cannot, more than the regressor takes if it keeps all, or what the stages
    /// report.
    pub fn shard(
        &self,
        rig: &Rig,
        hand: &HandShape,
        scenes: &dyn SceneSource,
        shard: Shard,
        progress: &dyn Progress,
    ) -> Result<PartialTraining> {
        let mut part = self.begin(rig, hand, scenes, progress)?;
        part.add_shard(scenes, shard, &mut |_| {}, progress)?;
        Ok(part)
    }

    /// A part that has seen no block yet.
    pub(crate) fn begin(
        &self,
        rig: &Rig,
        hand: &HandShape,
        scenes: &dyn SceneSource,
        progress: &dyn Progress,
    ) -> Result<PartialTraining> {
        rig.validate()?;
        hand.validate()?;
        let plan = self.plan(rig, hand, scenes, progress)?;
        let statistics = TrainingStatistics::new(&plan, &plan.columns()?);
        Ok(PartialTraining {
            plan,
            scenes: scenes.count(),
            blocks: Vec::new(),
            losses: Losses::default(),
            statistics,
            components: BTreeMap::new(),
            errors: None,
            makers: vec![Maker::here()],
        })
    }
}

impl PartialTraining {
    /// The scenes that could not be described so far.
    pub fn losses(&self) -> &Losses {
        &self.losses
    }

    /// What made the part: more than one where parts of unlike versions or machines were merged.
    pub fn makers(&self) -> &[Maker] {
        &self.makers
    }

    /// How many scenes it has seen, those that could not be described among them.
    pub fn seen(&self) -> usize {
        self.blocks.iter().map(|&block| scenes_of(block, self.scenes).len()).sum()
    }

    /// Adds the blocks of a shard that it has not seen yet, and shows itself to `keep` after each.
    pub(crate) fn add_shard(
        &mut self,
        scenes: &dyn SceneSource,
        shard: Shard,
        keep: &mut dyn FnMut(&Self),
        progress: &dyn Progress,
    ) -> Result<()> {
        let columns = self.plan.columns()?;
        let mut blocks: Vec<usize> = shard.blocks(self.scenes).collect();
        blocks.retain(|block| self.blocks.binary_search(block).is_err());
        let shown = blocks.iter().map(|&block| scenes_of(block, self.scenes).len()).sum();
        progress.begin("render, describe, sum", shown);
        for block in blocks {
            let numbers: Vec<usize> = scenes_of(block, self.scenes).collect();
            let TrainingPlan { rig, descriptor, .. } = &self.plan;
            let described = describe_scenes(rig, scenes, &numbers, descriptor, progress)?;
            let (kept, x) = described_ones(&numbers, described, &mut self.losses);
            if !kept.is_empty() {
                let y = targets_of(scenes, &kept);
                if let Some(components) = self.plan.subset_components(block, self.scenes) {
                    let z = components.apply(x.as_ref())?;
                    self.components.insert(block, Samples::new(&z, &y, |value| value as f32));
                }
                self.statistics.add(&self.plan, &columns, block, x, &y)?;
            }
            self.blocks.push(block);
            self.blocks.sort_unstable();
            keep(self);
        }
        Ok(())
    }

    /// The same part, whose estimator has no model of its errors and so no hypotheses.
    #[must_use]
    pub fn without_error_model(self) -> Self {
        self.with_error_scenes(None)
    }

    pub(crate) fn with_error_scenes(self, errors: Option<ErrorScenes>) -> Self {
        Self { errors, ..self }
    }

    /// Adds another part of the same training.
    ///
    /// # Errors
    /// A part of another training, or one that holds a block that is here already.
    pub fn merge(&mut self, other: Self) -> Result<()> {
        self.check_same_training(&other)?;
        let held = |block: &&usize| self.blocks.binary_search(block).is_ok();
        if let Some(&block) = other.blocks.iter().find(held) {
            let both = scenes_of(block, self.scenes);
            return Err(Error::Overlap { first: both.start, last: both.end - 1 });
        }
        self.statistics.merge(other.statistics)?;
        self.components.extend(other.components);
        self.blocks.extend(other.blocks);
        self.blocks.sort_unstable();
        self.losses.merge(other.losses);
        self.makers.extend(other.makers);
        self.makers.sort_unstable();
        self.makers.dedup();
        Ok(())
    }

    /// Refuses a part of another training.
    fn check_same_training(&self, other: &Self) -> Result<()> {
        for (what, differ) in [
            ("their rigs", self.plan.rig != other.plan.rig),
            ("their hands", self.plan.hand != other.plan.hand),
            ("their numbers of scenes", self.scenes != other.scenes),
            ("their regressors", self.plan.regressor != other.plan.regressor),
            ("what they learn from", self.plan != other.plan),
            ("what their errors are learnt from", self.errors != other.errors),
        ] {
            if differ {
                return Err(Error::ForeignPart { what });
            }
        }
        Ok(())
    }

    /// This part, to which nothing was added yet, with what an earlier run of the same training had seen of a
    /// shard.
    ///
    /// # Errors
    /// A part of another training, or one that has seen blocks beyond the shard.
    pub(crate) fn with_seen(mut self, earlier: Self, shard: Shard) -> Result<Self> {
        self.check_same_training(&earlier)?;
        let blocks = shard.blocks(self.scenes);
        if !earlier.blocks.iter().all(|block| blocks.contains(block)) {
            return Err(Error::ForeignPart { what: "their shards" });
        }
        self.merge(earlier)?;
        Ok(self)
    }

    /// The estimator, once all parts are merged; of a [`Trainer`](crate::Trainer)'s parts with the model
    /// of its errors.
    ///
    /// # Errors
    /// A missing part, more than [`Losses::MOST`] of the scenes lost, or what the regressor reports.
    pub fn finish(self, progress: &dyn Progress) -> Result<Estimator> {
        let all = self.scenes.div_ceil(BLOCK);
        if let Some(missing) = (0..all).find(|block| self.blocks.get(*block) != Some(block)) {
            let missing = scenes_of(missing, self.scenes);
            return Err(Error::MissingPart { first: missing.start, last: missing.end - 1 });
        }
        self.losses.check(self.scenes)?;
        if self.losses.count() > 0 {
            progress.lost(&self.losses, self.scenes);
        }
        let (regression, subsets) = self.statistics.fit(&self.plan, progress)?;
        let subsets = match subsets {
            None => self.plan.fit_subsets(&Samples::of_blocks(self.components), progress)?,
            some => some,
        };
        let TrainingPlan { rig, hand, descriptor, .. } = self.plan;
        let estimator = Estimator::from_parts(rig.clone(), hand.clone(), descriptor, regression)?
            .with_subsets(subsets)?;
        match self.errors {
            Some(ErrorScenes { sampler, count, refined }) => estimator
                .fit_error_model(&sampler.scenes(&rig, &hand, count), progress)?
                .fit_refined_errors(&sampler.fresh(), refined, progress),
            None => Ok(estimator),
        }
    }
}
