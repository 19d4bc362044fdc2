//! Histograms like shape contexts: sparse, about twenty filled bins in sixty, in loose clusters.

use rand_core::Rng;
use rand_pcg::Pcg64;

pub(crate) const DIM: usize = 60;

fn uniform(rng: &mut Pcg64) -> f32 {
    (rng.next_u32() >> 8) as f32 / (1_u32 << 24) as f32
}

/// `count` histograms around 40 prototypes, one after the other.
pub(crate) fn histograms(count: usize, seed: u64) -> Vec<f32> {
    let mut rng = Pcg64::new(u128::from(seed), 0);
    let mut draw = |chance: f32| if uniform(&mut rng) < chance { uniform(&mut rng) } else { 0.0 };
    let prototypes: Vec<f32> = (0..40 * DIM).map(|_| draw(0.35)).collect();
    let mut samples = Vec::with_capacity(count * DIM);
    for i in 0..count {
        let prototype = &prototypes[i * 7 % 40 * DIM..][..DIM];
        let heights: Vec<f32> = prototype.iter().map(|p| p * draw(0.9) + draw(0.05)).collect();
        let sum: f32 = heights.iter().sum();
        samples.extend(heights.iter().map(|h| h / sum));
    }
    samples
}
