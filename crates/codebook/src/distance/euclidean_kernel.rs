//! Squared Euclidean distances of one vector and many.
#![allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]

use pulp::{Simd, WithSimd};

use crate::distance::lanes::{LANES, Lanes};
use crate::distance::support::Support;

pub(crate) struct Euclidean<'a> {
    pub(crate) dim: usize,
    pub(crate) blocks: &'a [Lanes],
    pub(crate) offsets: &'a [Lanes],
    pub(crate) to: &'a Support,
    pub(crate) distances: &'a mut [f32],
}

impl WithSimd for Euclidean<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let mut columns = Columns {
            simd,
            dim: self.dim,
            blocks: S::as_simd_f32s(self.blocks.as_flattened()).0,
            offsets: S::as_simd_f32s(self.offsets.as_flattened()).0,
            to: self.to,
            distances: S::as_mut_simd_f32s(self.distances).0,
            smallest: simd.splat_f32s(f32::INFINITY),
        };
        // As many sums as fit into the registers of usual processors, so that no addition waits
        // for the last.
        let next = columns.compare::<12>(0);
        let next = columns.compare::<4>(next);
        columns.compare::<1>(next);
        simd.reduce_min_f32s(columns.smallest)
    }
}

/// The vectors, as many of each block in a column as a register holds.
struct Columns<'a, S: Simd> {
    simd: S,
    dim: usize,
    blocks: &'a [S::f32s],
    offsets: &'a [S::f32s],
    to: &'a Support,
    distances: &'a mut [S::f32s],
    smallest: S::f32s,
}

impl<S: Simd> Columns<'_, S> {
    /// How many there are in a block.
    const IN_BLOCK: usize = LANES / S::F32_LANES;

    /// The distances of `N` columns at once, while so many are left; returns the first that was not
    /// compared.
    #[inline(always)]
    fn compare<const N: usize>(&mut self, mut first: usize) -> usize {
        while first + N <= self.offsets.len() {
            let sums = self.sums::<N>(first);
            let last = first + N;
            let distances = self.distances[first..last].iter_mut();
            for ((distance, offset), sum) in distances.zip(&self.offsets[first..last]).zip(sums) {
                // What rounding made negative is none.
                let sum = self.simd.add_f32s(sum, *offset);
                *distance = self.simd.max_f32s(sum, self.simd.splat_f32s(0.0));
                self.smallest = self.simd.min_f32s(self.smallest, *distance);
            }
            first = last;
        }
        first
    }

    /// Σ (h − c)² is Σ c² + Σ h² + Σ h (−2 c): the last two, the first being the offset of c.
    #[inline(always)]
    fn sums<const N: usize>(&self, first: usize) -> [S::f32s; N] {
        let length = (self.dim - 1) * Self::IN_BLOCK + 1;
        let columns: [&[S::f32s]; N] = std::array::from_fn(|column| {
            let (block, column) =
                ((first + column) / Self::IN_BLOCK, (first + column) % Self::IN_BLOCK);
            &self.blocks[block * self.dim * Self::IN_BLOCK + column..][..length]
        });
        let mut sums = [self.simd.splat_f32s(self.to.mass); N];
        for (bin, &value) in self.to.moved[..self.dim].iter().enumerate() {
            let value = self.simd.splat_f32s(value);
            for (sum, column) in sums.iter_mut().zip(columns) {
                *sum = self.simd.mul_add_e_f32s(value, column[bin * Self::IN_BLOCK], *sum);
            }
        }
        sums
    }
}
