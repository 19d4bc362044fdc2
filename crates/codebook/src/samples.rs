use crate::{Error, Result};

/// How far the sum of a histogram may be from 1.
pub const SUM_TOLERANCE: f64 = 1e-3;

/// Checks that `values` are histograms of `dim` bins, one after the other, and at least one.
pub(crate) fn check(what: &'static str, values: &[f32], dim: usize) -> Result<()> {
    if values.is_empty() {
        return Err(Error::Empty { what });
    }
    if dim == 0 || !values.len().is_multiple_of(dim) {
        return Err(Error::Shape { what, values: values.len(), dim });
    }
    values.chunks_exact(dim).enumerate().try_for_each(|(i, h)| check_one(what, i, h))
}

fn check_one(what: &'static str, index: usize, histogram: &[f32]) -> Result<()> {
    let (sum, smallest) = sum_and_smallest(histogram);
    // Whatever is not finite makes the sum so too.
    if smallest < 0.0 || !sum.is_finite() {
        let bad = |&(_, h): &(usize, &f32)| !(h.is_finite() && *h >= 0.0);
        if let Some((bin, &value)) = histogram.iter().enumerate().find(bad) {
            return Err(Error::BadHeight { what, index, bin, value });
        }
    }
    if (sum - 1.0).abs() > SUM_TOLERANCE {
        return Err(Error::NotNormalised { what, index, sum });
    }
    Ok(())
}

/// In partial sums and minima, so that the loop becomes vector instructions.
fn sum_and_smallest(histogram: &[f32]) -> (f64, f32) {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let mut smallest = [0.0; LANES];
    for chunk in histogram.chunks(LANES) {
        for ((&h, sum), least) in chunk.iter().zip(&mut sums).zip(&mut smallest) {
            *sum += f64::from(h);
            *least = if h < *least { h } else { *least };
        }
    }
    (sums.iter().sum(), smallest.into_iter().fold(0.0, f32::min))
}
