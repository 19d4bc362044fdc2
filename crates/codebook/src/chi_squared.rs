#![allow(clippy::inline_always, reason = "must be compiled with the caller's instruction set")]

/// Partial sums, so that the loop becomes vector instructions.
const LANES: usize = 16;

/// The χ² statistic of two histograms, ½ Σ (a − b)² / (a + b) with 0/0 = 0 (Puzicha, Hofmann and
/// Buhmann, 1997; Belongie, Malik and Puzicha, 2002, equation 1): between 0 and 1 when both sum to
/// 1, and already a square, as its root is a metric.
///
/// Bins beyond the shorter histogram are not looked at.
pub fn chi_squared(a: &[f32], b: &[f32]) -> f32 {
    between(a, b)
}

#[inline(always)]
pub(crate) fn between(a: &[f32], b: &[f32]) -> f32 {
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (b_chunks, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a_chunks.iter().zip(b_chunks) {
        for lane in 0..LANES {
            sums[lane] += term(a[lane], b[lane]);
        }
    }
    for ((sum, a), b) in sums.iter_mut().zip(a_rest).zip(b_rest) {
        *sum += term(*a, *b);
    }
    0.5 * sums.iter().sum::<f32>()
}

#[inline(always)]
fn term(a: f32, b: f32) -> f32 {
    let sum = a + b;
    // Avoids 0/0; no height that matters is this small.
    let sum = if sum > f32::MIN_POSITIVE { sum } else { f32::MIN_POSITIVE };
    (a - b) * (a - b) / sum
}
