//! The paper's even split of a data set into training and test samples.

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Which samples are learnt from and which are tested on; both in order, no sample in both.
pub(crate) struct Split {
    pub(crate) train: Vec<usize>,
    pub(crate) test: Vec<usize>,
}

impl Split {
    /// A random half of `samples`, the larger one of an odd number, to learn from; the rest to
    /// test on.
    pub(crate) fn even(samples: usize, seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut order: Vec<usize> = (0..samples).collect();
        for last in (1..samples).rev() {
            let other = (random.next_u64() % (last as u64 + 1)) as usize;
            order.swap(last, other);
        }
        let (train, test) = order.split_at(samples.div_ceil(2));
        let sorted = |half: &[usize]| {
            let mut half = half.to_vec();
            half.sort_unstable();
            half
        };
        Self { train: sorted(train), test: sorted(test) }
    }
}

#[cfg(test)]
mod tests {
    use super::Split;

    #[test]
    fn every_sample_is_in_exactly_one_half() {
        for samples in [1, 2, 546, 1673] {
            let split = Split::even(samples, 7);
            assert_eq!(split.train.len(), samples.div_ceil(2));
            let mut all = [split.train, split.test].concat();
            all.sort_unstable();
            assert_eq!(all, (0..samples).collect::<Vec<_>>());
        }
    }

    #[test]
    fn another_seed_is_another_split() {
        assert_ne!(Split::even(100, 0).train, Split::even(100, 1).train);
        assert_eq!(Split::even(100, 1).train, Split::even(100, 1).train);
    }
}
