//! Scaling rows to zero mean and unit variance.

use faer::{Mat, MatRef};

use crate::data::check;
use crate::error::{Error, Result};

/// A row varies only if its standard deviation exceeds this fraction of its largest magnitude:
/// below it the variation is the rounding of the row's own values.
const RELATIVE_FLOOR: f64 = 1e-12;
/// Smallest standard deviation that can be divided by safely.
const ABSOLUTE_FLOOR: f64 = 1e-150;

/// Scales each row of a matrix (samples in columns) to zero mean and unit variance.
///
/// Agarwal and Triggs (2006), de Campos and Murray (2006, section 4): ridge solutions are not
/// equivariant under scaling of inputs, so both inputs and targets are standardised first. The
/// variance divides by the number of samples. A row that does not vary has scale 0: it becomes 0,
/// and 0 becomes its constant again, exactly.
///
/// ```
/// use phalanx_rvm::{StandardScaler, faer::mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = mat![[1.0, 3.0], [5.0, 5.0]]; // the second row does not vary
/// let standardiser = StandardScaler::fit(x.as_ref())?;
/// assert_eq!(standardiser.scale(), [1.0, 0.0]);
/// let z = standardiser.apply(x.as_ref())?;
/// assert_eq!(z, mat![[-1.0, 1.0], [0.0, 0.0]]);
/// assert_eq!(standardiser.invert(z.as_ref())?, x);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StandardScaler {
    mean: Vec<f64>,
    scale: Vec<f64>,
}

impl StandardScaler {
    /// Measures the rows of `x`, K×I with a sample in each column.
    pub fn fit(x: MatRef<'_, f64>) -> Result<Self> {
        check::matrix("x", x)?;
        let (mean, scale) = (0..x.nrows()).map(|i| moments(x, i)).unzip();
        Ok(Self { mean, scale })
    }

    /// Measures the rows of `x` as [`fit`](Self::fit) does, but divides all that vary by one number,
    /// so that they keep their proportions: their mean variance becomes 1.
    pub fn in_proportion(x: MatRef<'_, f64>) -> Result<Self> {
        let mut each = Self::fit(x)?;
        let varying = each.varying();
        let total: f64 = each.scale.iter().map(|scale| scale * scale).sum();
        let common = (total / varying.len().max(1) as f64).sqrt();
        for row in varying {
            each.scale[row] = common;
        }
        Ok(each)
    }

    /// Assembles a scaler from the mean and the standard deviation (0: constant) of each row.
    pub fn from_parts(mean: Vec<f64>, scale: Vec<f64>) -> Result<Self> {
        check::length("scales", mean.len(), scale.len())?;
        if !mean.iter().all(|&v| check::usable(v)) {
            return Err(Error::Parts { field: "mean", problem: "holds an unusable number" });
        }
        if !scale.iter().all(|&v| v == 0.0 || check::usable(v) && v > ABSOLUTE_FLOOR) {
            return Err(Error::Parts { field: "scale", problem: "holds an unusable number" });
        }
        Ok(Self { mean, scale })
    }

    /// Mean of each row.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Standard deviation of each row, 0 for a row that does not vary.
    pub fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// The rows that vary, ascending.
    pub fn varying(&self) -> Vec<usize> {
        (0..self.scale.len()).filter(|&i| self.scale[i] > 0.0).collect()
    }

    /// The rows of `x` scaled by these means and deviations; constant rows become 0.
    pub fn apply(&self, x: MatRef<'_, f64>) -> Result<Mat<f64>> {
        check::length("rows of x", self.mean.len(), x.nrows())?;
        Ok(Mat::from_fn(x.nrows(), x.ncols(), |i, j| self.scaled(i, x[(i, j)])))
    }

    /// The inverse of [`apply`](Self::apply); constant rows become their constant.
    pub fn invert(&self, z: MatRef<'_, f64>) -> Result<Mat<f64>> {
        check::length("rows of z", self.mean.len(), z.nrows())?;
        Ok(Mat::from_fn(z.nrows(), z.ncols(), |i, j| self.mean[i] + self.scale[i] * z[(i, j)]))
    }

    /// How many standard deviations a value of row `i` lies from its mean; for a row that does not
    /// vary, how many of the least that would count as varying.
    pub(crate) fn deviations(&self, i: usize, value: f64) -> f64 {
        (value - self.mean[i]).abs() / self.scale[i].max(floor(self.mean[i].abs()))
    }

    /// One value of row `i`, scaled.
    pub(crate) fn scaled(&self, i: usize, value: f64) -> f64 {
        if self.scale[i] > 0.0 { (value - self.mean[i]) / self.scale[i] } else { 0.0 }
    }
}

/// Mean and standard deviation of row `i`, without overflow whatever its magnitude.
fn moments(x: MatRef<'_, f64>, i: usize) -> (f64, f64) {
    let row = x.row(i);
    let first = row[0];
    if row.iter().all(|&v| v == first) {
        return (first, 0.0);
    }
    let n = row.ncols() as f64;
    let mean = row.iter().sum::<f64>() / n;
    let scale = (row.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
    let largest = row.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    (mean, if scale > floor(largest) { scale } else { 0.0 })
}

/// Most standard deviation of a row that does not vary, from its largest magnitude.
fn floor(largest: f64) -> f64 {
    (RELATIVE_FLOOR * largest).max(ABSOLUTE_FLOOR)
}
