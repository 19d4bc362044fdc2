//! Histograms laid out so that another one meets many of them at once.
#![allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// Histograms that are compared together.
pub(crate) const LANES: usize = 16;

/// One number for each histogram of a block.
type Lanes = [f32; LANES];

/// Heights up to this count as zero. They would change χ² by less than f32 can show, and without
/// them no product of two denominators underflows.
const NEGLIGIBLE: f32 = 1e-12;

/// Histograms in blocks of [`LANES`], bin by bin within a block. The last block is filled up with
/// histograms infinitely far from everything.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Packed {
    dim: usize,
    /// `blocks[block * dim + bin][lane]`.
    blocks: Vec<Lanes>,
    /// Half of each histogram's sum.
    half_masses: Vec<Lanes>,
}

/// Some consecutive blocks of a [`Packed`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile<'a> {
    dim: usize,
    blocks: &'a [Lanes],
    half_masses: &'a [Lanes],
}

impl Packed {
    /// Packs histograms given one after the other.
    pub(crate) fn new(histograms: &[f32], dim: usize) -> Self {
        let count = (histograms.len() / dim).div_ceil(LANES);
        let mut packed = Self {
            dim,
            blocks: vec![[0.0; LANES]; count * dim],
            half_masses: vec![[f32::INFINITY; LANES]; count],
        };
        for (index, histogram) in histograms.chunks_exact(dim).enumerate() {
            let (block, lane) = (index / LANES, index % LANES);
            packed.half_masses[block][lane] = 0.5 * histogram.iter().sum::<f32>();
            for (bin, &height) in histogram.iter().enumerate() {
                packed.blocks[block * dim + bin][lane] = height;
            }
        }
        packed
    }

    /// All blocks.
    pub(crate) fn whole(&self) -> Tile<'_> {
        Tile { dim: self.dim, blocks: &self.blocks, half_masses: &self.half_masses }
    }

    /// The blocks in tiles of at most `histograms` (a multiple of [`LANES`]) each.
    pub(crate) fn tiles(&self, histograms: usize) -> impl IndexedParallelIterator<Item = Tile<'_>> {
        let blocks = self.blocks.par_chunks(histograms / LANES * self.dim);
        let half_masses = self.half_masses.par_chunks(histograms / LANES);
        blocks.zip(half_masses).map(|(blocks, half_masses)| Tile {
            dim: self.dim,
            blocks,
            half_masses,
        })
    }
}

impl Tile<'_> {
    /// Writes χ² to every histogram, in order and followed by infinities, and returns the smallest.
    pub(crate) fn compare(self, arch: Arch, to: &Support, distances: &mut Vec<f32>) -> f32 {
        distances.resize(self.half_masses.len() * LANES, 0.0);
        arch.dispatch(Compare { tile: self, to, distances })
    }
}

/// The filled bins of a histogram, two by two.
#[derive(Debug, Clone, Default)]
pub(crate) struct Support {
    bins: Vec<Bin>,
    pairs: Vec<Pair>,
    mass: f32,
}

#[derive(Debug, Clone, Copy, Default)]
struct Bin {
    index: usize,
    height: f32,
}

#[derive(Debug, Clone, Copy)]
struct Pair {
    a: Bin,
    b: Bin,
    /// a²
    squared: f32,
    /// b² / a²
    ratio: f32,
}

impl Support {
    pub(crate) fn find(&mut self, histogram: &[f32]) {
        self.bins.resize(histogram.len(), Bin::default());
        // Without a branch for the processor to guess.
        let mut filled = 0;
        for (index, &height) in histogram.iter().enumerate() {
            self.bins[filled] = Bin { index, height };
            filled += usize::from(height > NEGLIGIBLE);
        }
        let bins = &self.bins[..filled];
        self.mass = bins.iter().map(|bin| bin.height).sum();
        self.pairs.clear();
        self.pairs.extend(bins.chunks(2).map(|bins| Pair::new(bins[0], bins.get(1).copied())));
    }
}

impl Pair {
    fn new(a: Bin, b: Option<Bin>) -> Self {
        let squared = a.height * a.height;
        match b {
            Some(b) => Self { a, b, squared, ratio: b.height * b.height / squared },
            // Any b will do that keeps its denominator from zero.
            None => Self { a, b: Bin { index: a.index, height: 1.0 }, squared, ratio: 0.0 },
        }
    }
}

struct Compare<'a> {
    tile: Tile<'a>,
    to: &'a Support,
    distances: &'a mut [f32],
}

impl NullaryFnOnce for Compare<'_> {
    type Output = f32;

    /// With h c / (h + c) = h − h² / (h + c), χ² = ½ Σ (h − c)² / (h + c) is
    /// ½ Σc − 3/2 Σh + 2 Σ h² / (h + c), whose last sum needs the filled bins of h only.
    #[inline(always)]
    fn call(self) -> f32 {
        let Tile { dim, blocks, half_masses } = self.tile;
        let offset = -1.5 * self.to.mass;
        let (distances, _) = self.distances.as_chunks_mut::<LANES>();
        let mut smallest = [f32::INFINITY; LANES];
        for ((block, half_masses), distances) in
            blocks.chunks_exact(dim).zip(half_masses).zip(distances)
        {
            let sums = overlap(block, &self.to.pairs);
            for lane in 0..LANES {
                let distance = half_masses[lane] + offset + 2.0 * sums[lane];
                // Rounding can make it negative.
                distances[lane] = if distance > 0.0 { distance } else { 0.0 };
            }
            for (least, &mut distance) in smallest.iter_mut().zip(distances) {
                *least = if distance < *least { distance } else { *least };
            }
        }
        smallest.into_iter().fold(f32::INFINITY, f32::min)
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
