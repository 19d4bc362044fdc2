//! k-means++ (Arthur and Vassilvitskii, 2007) with the χ² statistic as the squared distance.
#![allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]

use pulp::{Arch, NullaryFnOnce};
use rand_core::Rng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::{Error, Result, chi_squared, lloyd::BLOCK};

/// The first centre is a sample drawn evenly, each further one a sample drawn in proportion to its
/// χ² to the nearest centre so far. Samples that equal a centre cannot be drawn, so the centres
/// differ.
pub(crate) fn seed(samples: &[f32], dim: usize, count: usize, rng: &mut Pcg64) -> Result<Vec<f32>> {
    let sample = |i: usize| &samples[i * dim..(i + 1) * dim];
    let n = samples.len() / dim;
    let mut centres = Vec::with_capacity(count * dim);
    let mut distances = vec![f32::INFINITY; n];
    let mut drawn = ((uniform(rng) * n as f64) as usize).min(n - 1);
    for chosen in 1..=count {
        centres.extend_from_slice(sample(drawn));
        if chosen == count {
            break;
        }
        approach(samples, dim, sample(drawn), &mut distances);
        drawn = draw(&distances, uniform(rng))
            .ok_or(Error::TooFewDistinct { distinct: chosen, centres: count })?;
    }
    Ok(centres)
}

/// Lowers each sample's distance to that from a new centre, where that is smaller.
fn approach(samples: &[f32], dim: usize, centre: &[f32], distances: &mut [f32]) {
    let arch = Arch::new();
    samples.par_chunks(BLOCK * dim).zip(distances.par_chunks_mut(BLOCK)).for_each(
        |(samples, distances)| arch.dispatch(Approach { samples, dim, centre, distances }),
    );
}

struct Approach<'a> {
    samples: &'a [f32],
    dim: usize,
    centre: &'a [f32],
    distances: &'a mut [f32],
}

impl NullaryFnOnce for Approach<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (sample, distance) in self.samples.chunks_exact(self.dim).zip(self.distances) {
            *distance = distance.min(chi_squared::between(sample, self.centre));
        }
    }
}

/// The index at which the running sum of the weights passes `portion` (0 to 1) of their total;
/// none when all are zero.
fn draw(weights: &[f32], portion: f64) -> Option<usize> {
    let target = portion * weights.iter().map(|&w| f64::from(w)).sum::<f64>();
    let mut sum = 0.0;
    let passed = weights.iter().position(|&w| {
        sum += f64::from(w);
        sum > target
    });
    // Rounding can put the target at the very end.
    passed.or_else(|| weights.iter().rposition(|&w| w > 0.0))
}

/// A number from 0 up to 1, excluded.
fn uniform(rng: &mut Pcg64) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}
