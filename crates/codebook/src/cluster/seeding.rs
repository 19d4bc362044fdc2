//! k-means++ (Arthur and Vassilvitskii, 2007), greedy if asked to be.

use pulp::Arch;
use rand_core::Rng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::cluster::lloyd::BLOCK;
use crate::distance::metric::Metric;
use crate::distance::packed::Packed;
use crate::distance::support::Support;
use crate::error::{Error, Result};

/// Distances below this part of χ²'s largest, or of a squared length, may be rounding alone.
const DOUBTFUL: f32 = 1e-5;

/// What the first centres are chosen from.
#[derive(Clone, Copy)]
pub(crate) struct Seeding<'a> {
    pub(crate) metric: Metric,
    pub(crate) samples: &'a [f32],
    pub(crate) dim: usize,
    /// The samples once more.
    pub(crate) packed: &'a Packed,
}

impl Seeding<'_> {
    /// The first centre is a sample drawn evenly, each further one a sample drawn in proportion to
    /// its distance to the nearest centre so far: of several such candidates, that which leaves the
    /// smallest sum of distances. A sample that equals a centre cannot be drawn, so the centres
    /// differ.
    pub(crate) fn seed(
        &self,
        count: usize,
        candidates: usize,
        rng: &mut Pcg64,
    ) -> Result<Vec<f32>> {
        let n = self.samples.len() / self.dim;
        let first = ((uniform(rng) * n as f64) as usize).min(n - 1);
        let mut centres = Vec::with_capacity(count * self.dim);
        let mut next = self.approached(first, &vec![f32::INFINITY; n]);
        centres.extend_from_slice(self.sample(first));
        for chosen in 1..count {
            let distances = next.distances;
            let mut draw_one = || {
                let drawn = draw(&distances, uniform(rng))
                    .ok_or(Error::TooFewDistinct { distinct: chosen, centres: count })?;
                Ok(self.approached(drawn, &distances))
            };
            next = draw_one()?;
            for _ in 1..candidates {
                let other = draw_one()?;
                next = if other.sum < next.sum { other } else { next };
            }
            centres.extend_from_slice(self.sample(next.drawn));
        }
        Ok(centres)
    }

    fn sample(&self, index: usize) -> &[f32] {
        &self.samples[index * self.dim..(index + 1) * self.dim]
    }

    /// How far the samples are from their nearest centres once one of them is a centre too.
    ///
    /// The packed samples meet the one centre, as in an assignment the packed centres one sample.
    fn approached(&self, drawn: usize, distances: &[f32]) -> Candidate {
        let arch = Arch::new();
        let centre = self.sample(drawn);
        let mut support = Support::default();
        self.packed.load(centre, &mut support);
        let doubtful = DOUBTFUL * support.mass;
        let mut distances = distances.to_vec();
        let blocks = self.samples.par_chunks(BLOCK * self.dim);
        let tiles = self.packed.tiles(BLOCK).zip(blocks).zip(distances.par_chunks_mut(BLOCK));
        tiles.for_each_init(Vec::new, |to_centre, ((tile, samples), distances)| {
            tile.compare(arch, &support, to_centre);
            let samples = samples.chunks_exact(self.dim);
            for ((distance, &new), sample) in distances.iter_mut().zip(&*to_centre).zip(samples) {
                let exact = || self.metric.distance(sample, centre) as f32;
                *distance = distance.min(if new > doubtful { new } else { exact() });
            }
        });
        let sum = distances.iter().map(|&distance| f64::from(distance)).sum();
        Candidate { drawn, distances, sum }
    }
}

/// A sample that may become a centre.
struct Candidate {
    drawn: usize,
    /// How far each sample would then be from its nearest centre.
    distances: Vec<f32>,
    sum: f64,
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
pub(crate) fn uniform(rng: &mut Pcg64) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}
