use crate::distance::metric::Metric;
use crate::error::{Error, Result};
use crate::limits::{MAX_MAGNITUDE, SUM_TOLERANCE};

/// Checks that `values` are vectors of `dim` numbers that the metric can compare, one after the
/// other, and at least one.
pub(crate) fn check(metric: Metric, what: &'static str, values: &[f32], dim: usize) -> Result<()> {
    if values.is_empty() {
        return Err(Error::Empty { what });
    }
    if dim == 0 || !values.len().is_multiple_of(dim) {
        return Err(Error::Shape { what, values: values.len(), dim });
    }
    let mut vectors = values.chunks_exact(dim).enumerate();
    match metric {
        Metric::ChiSquared => vectors.try_for_each(|(i, h)| check_histogram(what, i, h)),
        Metric::Euclidean => vectors.try_for_each(|(i, v)| check_vector(what, i, v)),
    }
}

/// Refuses fewer samples than centres.
pub(crate) fn check_count(samples: usize, centres: usize) -> Result<()> {
    if samples < centres {
        return Err(Error::TooFewDistinct { distinct: samples, centres });
    }
    Ok(())
}

fn check_vector(what: &'static str, index: usize, vector: &[f32]) -> Result<()> {
    // A NaN compares false.
    let usable = |value: &f32| value.abs() <= MAX_MAGNITUDE;
    if vector.iter().fold(true, |all, value| all & usable(value)) {
        return Ok(());
    }
    let bin = vector.iter().position(|value| !usable(value)).unwrap_or_default();
    Err(Error::BadNumber { what, index, bin, value: vector[bin] })
}

fn check_histogram(what: &'static str, index: usize, histogram: &[f32]) -> Result<()> {
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
