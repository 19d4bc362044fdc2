//! χ² of one histogram and many.
#![allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]

use pulp::NullaryFnOnce;

use crate::distance::lanes::{LANES, Lanes};
use crate::distance::support::{Pair, Support};

/// Blocks that are compared together.
const TOGETHER: usize = 3;

pub(crate) struct ChiSquared<'a> {
    pub(crate) dim: usize,
    pub(crate) blocks: &'a [Lanes],
    pub(crate) offsets: &'a [Lanes],
    pub(crate) to: &'a Support,
    pub(crate) distances: &'a mut [f32],
}

impl NullaryFnOnce for ChiSquared<'_> {
    type Output = f32;

    #[inline(always)]
    fn call(self) -> f32 {
        let Self { dim, blocks, offsets, .. } = self;
        let (distances, _) = self.distances.as_chunks_mut::<LANES>();
        let whole = offsets.len() / TOGETHER * TOGETHER;
        let (blocks, last_blocks) = blocks.split_at(whole * dim);
        let (offsets, last_offsets) = offsets.as_chunks::<TOGETHER>();
        let (distances, last_distances) = distances.as_chunks_mut::<TOGETHER>();
        let mut smallest = [f32::INFINITY; LANES];
        for ((blocks, offsets), distances) in
            blocks.chunks_exact(TOGETHER * dim).zip(offsets).zip(distances)
        {
            *distances = of_blocks(blocks, offsets, dim, self.to);
            finish(distances, &mut smallest);
        }
        let last = last_blocks.chunks_exact(dim).zip(last_offsets).zip(last_distances);
        for ((block, offsets), distances) in last {
            let mut one: [Lanes; 1] = of_blocks(block, &[*offsets], dim, self.to);
            finish(&mut one, &mut smallest);
            [*distances] = one;
        }
        smallest.into_iter().fold(f32::INFINITY, f32::min)
    }
}

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
