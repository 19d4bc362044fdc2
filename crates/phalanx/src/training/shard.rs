//! How a training is spread over runs.

use std::ops::Range;
use std::str::FromStr;

use crate::error::{Error, Result};

/// Scenes that are drawn, described and summed together. Shards consist of whole blocks, so that
/// the sums of one block are the same in any of them.
pub(crate) const BLOCK: usize = 1024;

/// One of several runs that share a training's scenes, block by block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// The only run there is.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// The run of this number, from 1, of so many.
    ///
    /// # Errors
    /// A number that is 0 or beyond the last.
    pub fn new(index: usize, count: usize) -> Result<Self> {
        if (1..=count).contains(&index) {
            return Ok(Self { index, count });
        }
        Err(Error::Shard { index, count })
    }

    /// How many of so many scenes this run does.
    pub(crate) fn scenes(self, scenes: usize) -> usize {
        self.blocks(scenes).map(|block| scenes_of(block, scenes).len()).sum()
    }

    /// The blocks of this run, of so many scenes; none where there are more runs than blocks.
    pub(crate) fn blocks(self, scenes: usize) -> Range<usize> {
        let blocks = scenes.div_ceil(BLOCK);
        // No product of two lengths exceeds 128 bits.
        let upto = |shards: usize| (shards as u128 * blocks as u128 / self.count as u128) as usize;
        upto(self.index - 1)..upto(self.index)
    }
}

/// `i/n`, such as `1/4`.
impl FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let numbers = text.split_once('/').and_then(|(index, count)| {
            Some((index.trim().parse().ok()?, count.trim().parse().ok()?))
        });
        let (index, count) = numbers.ok_or_else(|| Error::NoShard { text: text.to_owned() })?;
        Self::new(index, count)
    }
}

/// The scenes of one block, of so many.
pub(crate) fn scenes_of(block: usize, scenes: usize) -> Range<usize> {
    let start = block.saturating_mul(BLOCK);
    start..start.saturating_add(BLOCK).min(scenes)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(crate::property::cases(64))]

        #[test]
        fn shards_hold_every_block_once_and_in_order(scenes in 0_usize..200_000, count in 1_usize..50) {
            let shards = (1..=count).map(|index| Shard::new(index, count).unwrap());
            let blocks: Vec<usize> = shards.flat_map(|shard| shard.blocks(scenes)).collect();
            let held: Vec<usize> = blocks.iter().flat_map(|&block| scenes_of(block, scenes)).collect();
            prop_assert_eq!(held, (0..scenes).collect::<Vec<_>>());
        }
    }

    #[test]
    fn more_shards_than_numbers_of_blocks_do_no_harm() {
        let last = Shard::new(usize::MAX, usize::MAX).unwrap();
        assert_eq!(last.blocks(5000), 4..5);
    }

    #[test]
    fn shards_are_read_as_i_of_n() {
        assert_eq!("2/3".parse::<Shard>().unwrap(), Shard::new(2, 3).unwrap());
        for text in ["", "1", "0/2", "3/2", "1/2/3", "a/b"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }

    #[test]
    fn there_is_no_shard_0_of_4_nor_5_of_4() {
        for index in [0, 5] {
            assert!(matches!(Shard::new(index, 4), Err(Error::Shard { .. })));
        }
    }
}
