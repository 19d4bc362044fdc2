#![doc = include_str!("../README.md")]

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// At most `count` of the indices 0..`all`, every subset equally likely, in ascending order.
///
/// Use it to choose pilots, centres and validation sets. Do not take every n-th sample instead: if
/// the samples are periodic, such as cycles of a motion, all of these can have the same phase.
///
/// The subset depends on `seed` alone. With the same seed a smaller subset is part of a larger one.
///
/// ```
/// use phalanx_sampling::random_subset;
///
/// let some = random_subset(1000, 10, 7);
/// assert!(some.len() == 10 && some.is_sorted() && some[9] < 1000);
/// assert_eq!(random_subset(3, 10, 7), [0, 1, 2]);
/// ```
pub fn random_subset(all: usize, count: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..all).collect();
    shuffle(&mut order, &mut Pcg64Mcg::seed_from_u64(seed));
    order.truncate(count);
    order.sort_unstable();
    order
}

/// One of the indices 0..`all` at random from each of at most `count` equal parts, in ascending order.
///
/// Use it where a subset should come from everywhere in a list, such as key frames of a recording.
///
/// ```
/// use phalanx_sampling::spread_subset;
///
/// let some = spread_subset(1000, 10, 7);
/// assert!(some.iter().enumerate().all(|(part, index)| index / 100 == part));
/// assert_eq!(spread_subset(3, 10, 7), [0, 1, 2]);
/// ```
pub fn spread_subset(all: usize, count: usize, seed: u64) -> Vec<usize> {
    let count = count.min(all);
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let first = |part: usize| part * all / count;
    (0..count).map(|part| first(part) + below(first(part + 1) - first(part), &mut random)).collect()
}

/// Puts a list into a random order (Fisher and Yates).
pub fn shuffle(order: &mut [usize], random: &mut impl Rng) {
    for last in (1..order.len()).rev() {
        order.swap(last, below(last + 1, random));
    }
}

/// One of 0..`count` at random. The bias of so short a range in 64 bits is negligible.
fn below(count: usize, random: &mut impl Rng) -> usize {
    ((u128::from(random.next_u64()) * count as u128) >> 64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smaller_subsets_are_part_of_larger_ones() {
        let (small, large) = (random_subset(500, 20, 3), random_subset(500, 90, 3));
        assert!(small.iter().all(|index| large.binary_search(index).is_ok()));
        assert_ne!(random_subset(500, 20, 4), small);
    }

    /// Every twelfth of these has the same phase.
    #[test]
    fn a_spread_subset_sees_every_phase_of_a_cycle() {
        let mut counts = [0; 12];
        for (part, index) in spread_subset(1200, 100, 3).into_iter().enumerate() {
            assert_eq!(index / 12, part);
            counts[index % 12] += 1;
        }
        assert!(counts.iter().all(|count| (2..20).contains(count)), "{counts:?}");
        assert_eq!(spread_subset(0, 5, 3), [0; 0]);
    }

    /// χ² of how often each of 20 indices is among 5, over 4,000 seeds: 95 is its 99.99 % quantile
    /// doubled, so that only a wrong algorithm can exceed it.
    #[test]
    fn every_index_is_as_likely_as_any_other() {
        let mut counts = [0.0_f64; 20];
        for seed in 0..4000 {
            for index in random_subset(20, 5, seed) {
                counts[index] += 1.0;
            }
        }
        let chi2: f64 = counts.iter().map(|count| (count - 1000.0).powi(2) / 1000.0).sum();
        assert!(chi2 < 95.0, "{chi2}");
    }
}
