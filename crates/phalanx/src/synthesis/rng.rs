//! Random numbers of one item of a seeded run.

use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// The random numbers of one item (a sample, a hand, a picture) of a run: they follow from the
/// run's seed and the item's number alone, so that no order of work changes them.
#[derive(Debug, Clone)]
pub struct ItemRng(Pcg64Mcg);

impl ItemRng {
    /// Of this item of the run with this seed.
    pub fn new(seed: u64, item: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(mixed(mixed(seed) ^ item)))
    }

    /// A seed for items of this one.
    pub fn seed(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Uniform among 0 … count − 1; `count` is at least 1.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.uniform() * count as f64) as usize).min(count.saturating_sub(1))
    }

    /// A unit vector, uniform on the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * cos, across * sin, z)
    }
}

/// A permutation of the 64-bit numbers that leaves no pattern (the finaliser of SplitMix64, Steele,
/// Lea and Flood 2014), so that neighbouring seeds and items have nothing in common.
fn mixed(mut z: u64) -> u64 {
    z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
