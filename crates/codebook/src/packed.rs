//! Vectors laid out so that another one meets many of them at once.
#![allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::{
    Metric,
    support::{Bin, Pair, Support},
};

/// Vectors that are compared together.
pub(crate) const LANES: usize = 16;

/// One number for each vector of a block.
pub(crate) type Lanes = [f32; LANES];

/// Vectors in blocks of [`LANES`], number by number within a block. The last block is filled up with
/// vectors infinitely far from everything.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Packed {
    metric: Metric,
    dim: usize,
    /// What was taken away from the vectors; see [`origin`].
    origin: Option<Vec<f32>>,
    /// `blocks[block * dim + bin][lane]`.
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
            packed.offsets[block][lane] = match metric {
                Metric::ChiSquared => 0.5 * moved.iter().sum::<f32>(),
                Metric::Euclidean => moved.iter().map(|value| value * value).sum(),
            };
            for (bin, &value) in moved.iter().enumerate() {
                packed.blocks[block * dim + bin][lane] = value;
            }
        }
        packed
    }

    /// Prepares a vector to be compared with these.
    pub(crate) fn load(&self, vector: &[f32], support: &mut Support) {
        match self.metric {
            Metric::ChiSquared => support.find_filled(vector),
            Metric::Euclidean => {
                let mut moved = std::mem::take(&mut support.moved);
                let is_moved = self.origin.is_some();
                if is_moved {
                    self.move_vector(vector, &mut moved);
                }
                support.find_terms(if is_moved { &moved } else { vector });
                support.moved = moved;
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
        distances.resize(self.offsets.len() * LANES, 0.0);
        match self.metric {
            Metric::ChiSquared => self.dispatch(arch, to, distances, ChiSquared),
            Metric::Euclidean => self.dispatch(arch, to, distances, Euclidean),
        }
    }

    fn dispatch<S: Sums>(self, arch: Arch, to: &Support, distances: &mut [f32], metric: S) -> f32 {
        arch.dispatch(Compare { tile: self, to, distances, _sums: metric })
    }
}

/// The distances from all vectors of some blocks, given their offsets. A trait and no closure, which would not be
/// compiled for the caller's instruction set.
trait Sums {
    /// `N` blocks at once, so that additions to one need not wait for the last.
    fn of_blocks<const N: usize>(
        blocks: &[Lanes],
        offsets: &[Lanes; N],
        dim: usize,
        to: &Support,
    ) -> [Lanes; N];
}

struct ChiSquared;

impl Sums for ChiSquared {
    /// With h c / (h + c) = h − h² / (h + c), χ² = ½ Σ (h − c)² / (h + c) is
    /// ½ Σc − 3/2 Σh + 2 Σ h² / (h + c), whose last sum needs the filled bins of h only, and whose
    /// first is the offset of c.
    #[inline(always)]
    fn of_blocks<const N: usize>(
        blocks: &[Lanes],
        offsets: &[Lanes; N],
        dim: usize,
        to: &Support,
    ) -> [Lanes; N] {
        let mut sums = [[0.0; LANES]; N];
        for ((sums, offsets), block) in sums.iter_mut().zip(offsets).zip(blocks.chunks_exact(dim)) {
            *sums = overlap(block, &to.pairs);
            for (sum, offset) in sums.iter_mut().zip(offsets) {
                *sum = offset + -1.5 * to.mass + 2.0 * *sum;
            }
        }
        sums
    }
}

struct Euclidean;

impl Sums for Euclidean {
    /// Σ (h − c)² is Σ c² + Σ h² − 2 Σ h c, whose last sum needs the h only that are not zero, and
    /// whose first is the offset of c.
    #[inline(always)]
    fn of_blocks<const N: usize>(
        blocks: &[Lanes],
        offsets: &[Lanes; N],
        dim: usize,
        to: &Support,
    ) -> [Lanes; N] {
        let mut sums = [[to.mass; LANES]; N];
        let blocks: [&[Lanes]; N] = std::array::from_fn(|block| &blocks[block * dim..][..dim]);
        for &Bin { index, height } in to.terms() {
            for (sums, block) in sums.iter_mut().zip(blocks) {
                for (sum, value) in sums.iter_mut().zip(&block[index]) {
                    *sum -= height * value;
                }
            }
        }
        for (sums, offsets) in sums.iter_mut().zip(offsets) {
            for (sum, offset) in sums.iter_mut().zip(offsets) {
                *sum += offset;
            }
        }
        sums
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

/// Blocks that are compared together.
const TOGETHER: usize = 3;

struct Compare<'a, S> {
    tile: Tile<'a>,
    to: &'a Support,
    distances: &'a mut [f32],
    _sums: S,
}

impl<S: Sums> NullaryFnOnce for Compare<'_, S> {
    type Output = f32;

    #[inline(always)]
    fn call(self) -> f32 {
        let Tile { dim, blocks, offsets, .. } = self.tile;
        let (distances, _) = self.distances.as_chunks_mut::<LANES>();
        let whole = offsets.len() / TOGETHER * TOGETHER;
        let (blocks, last_blocks) = blocks.split_at(whole * dim);
        let (offsets, last_offsets) = offsets.as_chunks::<TOGETHER>();
        let (distances, last_distances) = distances.as_chunks_mut::<TOGETHER>();
        let mut smallest = [f32::INFINITY; LANES];
        for ((blocks, offsets), distances) in
            blocks.chunks_exact(TOGETHER * dim).zip(offsets).zip(distances)
        {
            *distances = S::of_blocks(blocks, offsets, dim, self.to);
            finish(distances, &mut smallest);
        }
        let last = last_blocks.chunks_exact(dim).zip(last_offsets).zip(last_distances);
        for ((block, offsets), distances) in last {
            let mut one: [Lanes; 1] = S::of_blocks(block, &[*offsets], dim, self.to);
            finish(&mut one, &mut smallest);
            [*distances] = one;
        }
        smallest.into_iter().fold(f32::INFINITY, f32::min)
    }
}

/// Takes away what rounding made negative, and lowers the smallest of each lane.
#[inline(always)]
fn finish<const N: usize>(distances: &mut [Lanes; N], smallest: &mut Lanes) {
    for distances in distances {
        for (distance, least) in distances.iter_mut().zip(&mut *smallest) {
            *distance = distance.max(0.0);
            *least = if *distance < *least { *distance } else { *least };
        }
    }
}

/// Σ h² / (h + c) for each histogram of a block, two bins to a division:
/// a²/p + b²/q = (q + p b²/a²) / (p q) a².
#[inline(always)]
fn overlap(block: &[Lanes], pairs: &[Pair]) -> Lanes {
    let mut sums = [0.0; LANES];
    for &Pair { a, b, squared, ratio } in pairs {
        let (a_heights, b_heights) = (&block[a.index], &block[b.index]);
        for lane in 0..LANES {
            let (p, q) = (a.height + a_heights[lane], b.height + b_heights[lane]);
            sums[lane] += (q + ratio * p) / (p * q) * squared;
        }
    }
    sums
}
