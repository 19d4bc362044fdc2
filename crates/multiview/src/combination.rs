//! High-level fusion: estimates of single views, joined.

use crate::error::{Error, Result};

/// What one view says of the m outputs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate<'a> {
    /// The estimates.
    pub mean: &'a [f64],
    /// Their standard deviations, finite and at least 0.
    pub std: &'a [f64],
}

/// The mean of the views' estimates, m numbers (§ 2 of the paper: combination "at a high level").
/// A missing view is one entry fewer.
///
/// # Errors
/// No view, views of different lengths, an estimate that is not finite.
///
/// ```
/// let views = [[10.0, -2.0], [14.0, 0.0]];
/// assert_eq!(phalanx_multiview::mean(&views)?, [12.0, -1.0]);
/// # Ok::<(), phalanx_multiview::Error>(())
/// ```
pub fn mean<E: AsRef<[f64]>>(estimates: &[E]) -> Result<Vec<f64>> {
    let outputs = estimates.first().ok_or(Error::NoViews)?.as_ref().len();
    let mut mean = vec![0.0; outputs];
    for (view, estimate) in estimates.iter().enumerate() {
        check(view, outputs, estimate.as_ref())?;
        for (mean, value) in mean.iter_mut().zip(estimate.as_ref()) {
            *mean += value / estimates.len() as f64;
        }
    }
    Ok(mean)
}

/// The views' estimates weighted by the inverses of their predictive variances, with the standard
/// deviations that follow if the views err independently: m numbers each. Views of one hand err
/// together, so that these deviations are lower bounds.
///
/// A deviation of 0 is certainty: where some views are certain, their mean is taken. A missing
/// view is one entry fewer.
///
/// # Errors
/// No view, views of different lengths, an estimate that is not finite, a deviation that is
/// negative or not finite.
///
/// ```
/// use phalanx_multiview::{Estimate, inverse_variance};
///
/// let sure = Estimate { mean: &[10.0], std: &[1.0] };
/// let unsure = Estimate { mean: &[20.0], std: &[3.0] };
/// let (mean, std) = inverse_variance(&[sure, unsure])?;
/// assert!((mean[0] - 11.0).abs() < 1e-12); // nine times the weight
/// assert!(std[0] < 1.0);
/// # Ok::<(), phalanx_multiview::Error>(())
/// ```
pub fn inverse_variance(estimates: &[Estimate<'_>]) -> Result<(Vec<f64>, Vec<f64>)> {
    let outputs = estimates.first().ok_or(Error::NoViews)?.mean.len();
    for (view, estimate) in estimates.iter().enumerate() {
        check(view, outputs, estimate.mean)?;
        check(view, outputs, estimate.std)?;
        if let Some(output) = estimate.std.iter().position(|&std| std < 0.0) {
            return Err(Error::Deviation { view, output, value: estimate.std[output] });
        }
    }
    Ok((0..outputs).map(|output| weigh(estimates, output)).unzip())
}

/// One output's weighted mean and its standard deviation.
fn weigh(estimates: &[Estimate<'_>], output: usize) -> (f64, f64) {
    let deviations = || estimates.iter().map(|estimate| estimate.std[output]);
    let least = deviations().fold(f64::INFINITY, f64::min);
    // Relative to the surest view: no deviation is too small to be squared.
    let weights = || deviations().map(|std| if std == least { 1.0 } else { (least / std).powi(2) });
    let total: f64 = weights().sum();
    let mean = estimates.iter().zip(weights()).map(|(of, weight)| of.mean[output] * weight / total);
    (mean.sum(), least / total.sqrt())
}

fn check(view: usize, outputs: usize, values: &[f64]) -> Result<()> {
    if values.len() != outputs {
        return Err(Error::EstimateLength { view, expected: outputs, found: values.len() });
    }
    match values.iter().position(|value| !value.is_finite()) {
        Some(output) => Err(Error::Estimate { view, output, value: values[output] }),
        None => Ok(()),
    }
}
