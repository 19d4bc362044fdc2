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
