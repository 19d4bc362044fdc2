//! The file of a part of a training, and whether what it holds fits together.

use crate::error::{Error, Result};
use crate::estimator::container::Container;
use crate::training::partial::PartialTraining;
use crate::training::shard::{BLOCK, scenes_of};

const PART: Container = Container { what: "training part", mark: *b"PHXPART\0", format: 8 };

impl PartialTraining {
    /// The part's file.
    ///
    /// # Errors
    /// None that a part can cause; encoding is fallible in form.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        PART.encode(self)
    }

    /// Reads a part's file.
    ///
    /// # Errors
    /// Bytes that are no part, of another format, truncated, corrupt, or that contradict
    /// themselves.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let part: Self = PART.decode(bytes)?;
        part.plan.rig.validate()?;
        part.plan.hand.validate()?;
        part.check_numbers()?;
        part.errors.iter().try_for_each(|errors| errors.sampler.check())?;
        let columns = part.plan.columns()?;
        let shown: usize = part.blocks.iter().map(|&b| scenes_of(b, part.scenes).len()).sum();
        let samples = shown.checked_sub(part.losses.count());
        part.statistics.check(&part.plan, &columns, &part.blocks, samples)?;
        part.check_components()?;
        Ok(part)
    }

    /// Do the numbers of scenes fit each other, and are there no more than training makes?
    fn check_numbers(&self) -> Result<()> {
        let ascending = |numbers: &[usize], end: usize| {
            numbers.is_sorted_by(|a, b| a < b) && numbers.last().is_none_or(|last| *last < end)
        };
        for (reason, holds) in [
            ("its blocks are not in order", ascending(&self.blocks, self.scenes.div_ceil(BLOCK))),
            ("its pilot is not in order", ascending(&self.plan.pilot, self.scenes)),
            ("its pilot is too large", self.plan.pilot.len() <= self.plan.regressor.centres()),
        ] {
            if !holds {
                return Err(Error::FileContent { what: PART.what, reason: reason.to_owned() });
            }
        }
        Ok(())
    }

    /// Are there components of the blocks that they are kept of, and of no others?
    fn check_components(&self) -> Result<()> {
        let mut wrong = self.components.iter().filter(|(block, samples)| {
            let components = self.plan.subset_components(**block, self.scenes);
            let whole = components.and_then(|components| samples.count(components.outputs()));
            whole.is_none() || self.blocks.binary_search(block).is_err()
        });
        match wrong.next() {
            Some((&found, _)) => {
                let expected = self.blocks.len();
                Err(Error::Mismatch {
                    part: "the number of a block of components",
                    found,
                    expected,
                })
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use phalanx_camera::Rig;
    use phalanx_hand::{Dof, HandShape, Pose};
    use phalanx_rvm::{BlockPca, Ridge};

    use super::*;
    use crate::progress::NoProgress;
    use crate::synthesis::scene::FixedPoses;
    use crate::training::feature_transform::FeatureTransform;
    use crate::training::recipe::Training;
    use crate::training::regressor::RegressorConfig;
    use crate::training::shard::Shard;
    use crate::training::statistics::TrainingStatistics;

    fn part() -> PartialTraining {
        let rig = Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap();
        let rig = rig.select(&["top"]).unwrap();
        let hand = HandShape::adult();
        let poses: Vec<Pose> = (0..24)
            .map(|k| {
                let mut pose = Pose::REST;
                pose[Dof::ThetaZ] = 0.06 * f64::from(k);
                pose
            })
            .collect();
        let mut training =
            Training { regressor: RegressorConfig::Ridge(Ridge::default()), ..Training::default() };
        training.vocabulary.centres = 10;
        training.vocabulary.most_samples = 500;
        let scenes = FixedPoses { rig: &rig, hand: &hand, poses: &poses };
        training.shard(&rig, &hand, &scenes, Shard::WHOLE, &NoProgress).unwrap()
    }

    #[test]
    fn parts_that_contradict_themselves_are_refused() {
        let good = part();
        assert_eq!(PartialTraining::from_bytes(&good.to_bytes().unwrap()).unwrap(), good);
        let spoils: [fn(&mut PartialTraining); 9] = [
            |part| part.blocks = vec![0, 0],
            |part| part.blocks = vec![1],
            |part| part.losses.add(0, &Error::TooFewPoses { found: 0 }),
            |part| part.plan.pilot.swap(0, 1),
            |part| part.plan.pilot_x.truncate(3),
            |part| part.scenes = usize::MAX,
            |part| {
                part.plan.transform =
                    FeatureTransform::Components(BlockPca::from_parts(Vec::new()));
            },
            |part| part.statistics = TrainingStatistics::Sums(Vec::new()),
            |part| part.statistics = TrainingStatistics::Samples(BTreeMap::new()),
        ];
        for (k, spoil) in spoils.into_iter().enumerate() {
            let mut spoilt = good.clone();
            spoil(&mut spoilt);
            let error = PartialTraining::from_bytes(&spoilt.to_bytes().unwrap()).unwrap_err();
            let named = matches!(error, Error::FileContent { .. } | Error::Mismatch { .. });
            assert!(named, "spoil {k}: {error}");
        }
    }
}
