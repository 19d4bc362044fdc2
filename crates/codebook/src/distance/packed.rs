//! Vectors laid out so that another one meets many of them at once.

use pulp::Arch;
use rayon::prelude::*;

use crate::distance::chi_squared_kernel::ChiSquared;
use crate::distance::euclidean_kernel::Euclidean;
use crate::distance::lanes::{LANES, Lanes};
use crate::distance::metric::Metric;
use crate::distance::support::Support;

/// Vectors in blocks of [`LANES`], number by number within a block. The last block is filled up with
/// vectors infinitely far from everything.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Packed {
    metric: Metric,
    dim: usize,
    /// What was taken away from the vectors; see [`origin`].
    origin: Option<Vec<f32>>,
    /// `blocks[block * dim + bin][lane]`; minus twice the number for Euclidean distances.
    blocks: Vec<Lanes>,
    /// What is added to each vector's distance: half a histogram's sum for χ², the square of
    /// the length otherwise.
    offsets: Vec<Lanes>,
}

/// Some consecutive blocks of a [`Packed`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile<'a> {
    metric: Metric,
    dim: usize,
    blocks: &'a [Lanes],
    offsets: &'a [Lanes],
}

impl Packed {
    /// Packs vectors given one after the other.
    pub(crate) fn new(metric: Metric, vectors: &[f32], dim: usize) -> Self {
        let count = (vectors.len() / dim).div_ceil(LANES);
        let origin = match metric {
            Metric::ChiSquared => None,
            Metric::Euclidean => origin(vectors, dim),
        };
        let mut packed = Self {
            metric,
            dim,
            origin,
            blocks: vec![[0.0; LANES]; count * dim],
            offsets: vec![[f32::INFINITY; LANES]; count],
        };
        let mut moved = Vec::with_capacity(dim);
        for (index, vector) in vectors.chunks_exact(dim).enumerate() {
            let (block, lane) = (index / LANES, index % LANES);
            packed.move_vector(vector, &mut moved);
            let (offset, factor) = match metric {
                Metric::ChiSquared => (0.5 * moved.iter().sum::<f32>(), 1.0),
                Metric::Euclidean => (moved.iter().map(|value| value * value).sum(), -2.0),
            };
            packed.offsets[block][lane] = offset;
            for (bin, &value) in moved.iter().enumerate() {
                packed.blocks[block * dim + bin][lane] = factor * value;
            }
        }
        packed
    }

    /// Prepares a vector to be compared with these.
    pub(crate) fn load(&self, vector: &[f32], support: &mut Support) {
        match self.metric {
            Metric::ChiSquared => support.find_filled(vector),
            Metric::Euclidean => {
                self.move_vector(vector, &mut support.moved);
                support.sum_squares();
            }
        }
    }

    fn move_vector(&self, vector: &[f32], moved: &mut Vec<f32>) {
        moved.clear();
        match &self.origin {
            Some(origin) => moved.extend(vector.iter().zip(origin).map(|(v, o)| v - o)),
            None => moved.extend_from_slice(vector),
        }
    }

    /// All blocks.
    pub(crate) fn whole(&self) -> Tile<'_> {
        let Self { metric, dim, ref blocks, ref offsets, .. } = *self;
        Tile { metric, dim, blocks, offsets }
    }

    /// The blocks in tiles of at most `vectors` (a multiple of [`LANES`]) each.
    pub(crate) fn tiles(&self, vectors: usize) -> impl IndexedParallelIterator<Item = Tile<'_>> {
        let blocks = self.blocks.par_chunks(vectors / LANES * self.dim);
        let offsets = self.offsets.par_chunks(vectors / LANES);
        let (metric, dim) = (self.metric, self.dim);
        blocks.zip(offsets).map(move |(blocks, offsets)| Tile { metric, dim, blocks, offsets })
    }
}

impl Tile<'_> {
    /// Writes the distance to every vector, in order and followed by infinities, and returns the
    /// smallest.
    pub(crate) fn compare(self, arch: Arch, to: &Support, distances: &mut Vec<f32>) -> f32 {
        let Self { metric, dim, blocks, offsets } = self;
        distances.resize(offsets.len() * LANES, 0.0);
        match metric {
            Metric::ChiSquared => arch.dispatch(ChiSquared { dim, blocks, offsets, to, distances }),
            Metric::Euclidean => arch.dispatch(Euclidean { dim, blocks, offsets, to, distances }),
        }
    }
}

/// Vectors further from zero, squared, than so many times their squared distance from their mean are
/// compared with the mean taken away, lest single precision lose what differs between them.
const FAR: f64 = 64.0;

/// The mean of vectors that are far from zero in comparison with their spread.
fn origin(vectors: &[f32], dim: usize) -> Option<Vec<f32>> {
    let count = (vectors.len() / dim) as f64;
    let mut mean = vec![0.0_f64; dim];
    let mut squares = 0.0;
    for vector in vectors.chunks_exact(dim) {
        for (mean, &value) in mean.iter_mut().zip(vector) {
            *mean += f64::from(value) / count;
            squares += f64::from(value) * f64::from(value) / count;
        }
    }
    let of_mean: f64 = mean.iter().map(|mean| mean * mean).sum();
    let is_far = of_mean > FAR * (squares - of_mean);
    is_far.then(|| mean.into_iter().map(|mean| mean as f32).collect())
}
