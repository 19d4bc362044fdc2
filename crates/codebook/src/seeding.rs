//! k-means++ (Arthur and Vassilvitskii, 2007) with the χ² statistic as the squared distance.

use pulp::Arch;
use rand_core::Rng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::{
    Error, Result,
    lloyd::BLOCK,
    packed::{Packed, Support},
};

/// Samples nearer than this are one and the same: the rounding of χ² in f32 is below it.
const SAME: f32 = 1e-6;

/// The first centre is a sample drawn evenly, each further one a sample drawn in proportion to its
/// χ² to the nearest centre so far. A sample that equals a centre cannot be drawn, so the centres
/// differ.
pub(crate) fn seed(
    samples: &[f32],
    dim: usize,
    packed: &Packed,
    count: usize,
    rng: &mut Pcg64,
) -> Result<Vec<f32>> {
    let n = samples.len() / dim;
    let mut centres = Vec::with_capacity(count * dim);
    let mut distances = vec![f32::INFINITY; n];
    let mut drawn = ((uniform(rng) * n as f64) as usize).min(n - 1);
    for chosen in 1..=count {
        let centre = &samples[drawn * dim..(drawn + 1) * dim];
        centres.extend_from_slice(centre);
        if chosen < count {
            approach(packed, centre, &mut distances);
            drawn = draw(&distances, uniform(rng))
                .ok_or(Error::TooFewDistinct { distinct: chosen, centres: count })?;
        }
    }
    Ok(centres)
}

/// Lowers each sample's distance to that from a new centre, where that is smaller.
///
/// The packed samples meet the one centre, as in an assignment the packed centres one sample.
fn approach(packed: &Packed, centre: &[f32], distances: &mut [f32]) {
    let arch = Arch::new();
    let mut support = Support::default();
    support.find(centre);
    packed.tiles(BLOCK).zip(distances.par_chunks_mut(BLOCK)).for_each_init(
        Vec::new,
        |to_centre, (tile, distances)| {
            tile.compare(arch, &support, to_centre);
            for (distance, &new) in distances.iter_mut().zip(&*to_centre) {
                *distance = if new < SAME { 0.0 } else { distance.min(new) };
            }
        },
    );
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
