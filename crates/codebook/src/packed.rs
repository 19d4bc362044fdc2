//! Centres laid out so that one sample meets many of them at once.
#![allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]

use pulp::{Arch, NullaryFnOnce};

/// Centres that are compared together.
const LANES: usize = 16;

/// Heights up to this count as zero. They would change χ² by less than f32 can show, and without
/// them the products of two denominators cannot underflow.
const NEGLIGIBLE: f32 = 1e-12;

/// Centres in blocks of [`LANES`], bin by bin within a block. The last block is filled up with
/// centres infinitely far from everything.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Packed {
    dim: usize,
    /// `blocks[block * dim + bin][lane]`.
    blocks: Vec<[f32; LANES]>,
    /// Half of each centre's sum.
    half_masses: Vec<[f32; LANES]>,
}

/// What is needed to compare one sample with the centres; kept from one sample to the next.
#[derive(Debug, Clone, Default)]
pub(crate) struct Comparison {
    /// The sample's bins that are not empty.
    support: Vec<Bin>,
    /// Its χ² to each centre, then those to the filling.
    distances: Vec<f32>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Bin {
    index: usize,
    height: f32,
}

impl Packed {
    /// Packs centres given one after the other.
    pub(crate) fn new(centres: &[f32], dim: usize) -> Self {
        let count = (centres.len() / dim).div_ceil(LANES);
        let mut packed = Self {
            dim,
            blocks: vec![[0.0; LANES]; count * dim],
            half_masses: vec![[f32::INFINITY; LANES]; count],
        };
        for (index, centre) in centres.chunks_exact(dim).enumerate() {
            let (block, lane) = (index / LANES, index % LANES);
            packed.half_masses[block][lane] = 0.5 * centre.iter().sum::<f32>();
            for (bin, &height) in centre.iter().enumerate() {
                packed.blocks[block * dim + bin][lane] = height;
            }
        }
        packed
    }

    /// χ² from a sample to every centre, in order and followed by infinities, and the smallest.
    pub(crate) fn compare<'a>(
        &self,
        arch: Arch,
        sample: &[f32],
        comparison: &'a mut Comparison,
    ) -> (&'a [f32], f32) {
        comparison.distances.resize(self.half_masses.len() * LANES, 0.0);
        comparison.support.resize(self.dim, Bin::default());
        let smallest = arch.dispatch(Compare { packed: self, sample, comparison });
        (&comparison.distances, smallest)
    }

    /// The nearest centre, the first of equals, and the χ² to it.
    pub(crate) fn nearest(
        &self,
        arch: Arch,
        sample: &[f32],
        comparison: &mut Comparison,
    ) -> (usize, f32) {
        let (distances, smallest) = self.compare(arch, sample, comparison);
        let nearest = distances.iter().position(|&d| d == smallest);
        (nearest.unwrap_or_default(), smallest)
    }
}

struct Compare<'a> {
    packed: &'a Packed,
    sample: &'a [f32],
    comparison: &'a mut Comparison,
}

impl NullaryFnOnce for Compare<'_> {
    type Output = f32;

    /// With h c / (h + c) = h − h² / (h + c), χ² = ½ Σ (h − c)² / (h + c) is
    /// ½ Σc − 3/2 Σh + 2 Σ h² / (h + c), of which the last sum needs the sample's filled bins only.
    #[inline(always)]
    fn call(self) -> f32 {
        let Comparison { support, distances } = self.comparison;
        let support = find_support(self.sample, support);
        let offset = -1.5 * support.iter().map(|bin| bin.height).sum::<f32>();
        let blocks = self.packed.blocks.chunks_exact(self.packed.dim);
        let mut smallest = [f32::INFINITY; LANES];
        for ((block, half_masses), distances) in
            blocks.zip(&self.packed.half_masses).zip(distances.as_chunks_mut::<LANES>().0)
        {
            let sums = overlap(block, support);
            for lane in 0..LANES {
                let distance = half_masses[lane] + offset + 2.0 * sums[lane];
                // Rounding can make it negative.
                let distance = if distance > 0.0 { distance } else { 0.0 };
                distances[lane] = distance;
                smallest[lane] = if distance < smallest[lane] { distance } else { smallest[lane] };
            }
        }
        smallest.into_iter().fold(f32::INFINITY, f32::min)
    }
}

/// Lists the filled bins of a sample, without a branch for the processor to guess.
#[inline(always)]
fn find_support<'a>(sample: &[f32], support: &'a mut [Bin]) -> &'a [Bin] {
    let mut filled = 0;
    for (index, &height) in sample.iter().enumerate() {
        support[filled] = Bin { index, height };
        filled += usize::from(height > NEGLIGIBLE);
    }
    &support[..filled]
}

/// Σ h² / (h + c) for each centre of a block, two bins to a division.
#[inline(always)]
fn overlap(block: &[[f32; LANES]], support: &[Bin]) -> [f32; LANES] {
    let mut sums = [0.0; LANES];
    let (pairs, odd) = support.as_chunks::<2>();
    for [a, b] in pairs {
        let (a_heights, b_heights) = (&block[a.index], &block[b.index]);
        let (a_squared, b_squared) = (a.height * a.height, b.height * b.height);
        for lane in 0..LANES {
            let (p, q) = (a.height + a_heights[lane], b.height + b_heights[lane]);
            sums[lane] += (a_squared * q + b_squared * p) / (p * q);
        }
    }
    for bin in odd {
        for lane in 0..LANES {
            sums[lane] += bin.height * bin.height / (bin.height + block[bin.index][lane]);
        }
    }
    sums
}
