//! The trait of everything that predicts.

use faer::{Mat, MatRef};

use crate::data::check;
use crate::error::Result;
use crate::model::scratch::Scratch;

/// A fitted regressor from K inputs to m targets, with a standard deviation for each target.
///
/// [`Model`](crate::Model), [`AugmentedRvm`](crate::AugmentedRvm),
/// [`GroupedRegressor`](crate::GroupedRegressor), [`Mlp`](crate::Mlp) and [`PcaMlp`](crate::PcaMlp)
/// are regressors. Implement the trait to use one of your own in their place; it is object safe.
///
/// ```
/// use phalanx_rvm::{Regressor, Result, Scratch, faer::mat};
///
/// /// Says the same whatever the input.
/// struct Constant {
///     mean: f64,
///     std: f64,
/// }
///
/// impl Regressor for Constant {
///     fn inputs(&self) -> usize {
///         2
///     }
///
///     fn outputs(&self) -> usize {
///         1
///     }
///
///     fn predict_into(&self, _: &[f64], _: &mut Scratch, mean: &mut [f64], std: &mut [f64]) -> Result<()> {
///         (mean[0], std[0]) = (self.mean, self.std);
///         Ok(())
///     }
/// }
///
/// # fn main() -> Result<()> {
/// let regressor: Box<dyn Regressor> = Box::new(Constant { mean: 3.0, std: 0.5 });
/// let (mean, std) = regressor.predict_with_std(mat![[1.0, 2.0], [3.0, 4.0]].as_ref())?;
/// assert_eq!((mean, std), (mat![[3.0, 3.0]], mat![[0.5, 0.5]]));
/// # Ok(())
/// # }
/// ```
pub trait Regressor: Send + Sync {
    /// Length K of an input.
    fn inputs(&self) -> usize;

    /// Number m of targets.
    fn outputs(&self) -> usize;

    /// Mean and standard deviation of the m targets of one input `x` (length K), in the targets'
    /// units. A deviation is infinite where the training samples do not tell it. `scratch` is working
    /// memory, whose content means nothing.
    ///
    /// # Errors
    /// Lengths other than K and m, and inputs that are not finite.
    fn predict_into(
        &self,
        x: &[f64],
        scratch: &mut Scratch,
        mean: &mut [f64],
        std: &mut [f64],
    ) -> Result<()>;

    /// Mean and standard deviation, both m×T, for each column of `x`, K×T.
    ///
    /// # Errors
    /// As [`predict_into`](Self::predict_into).
    fn predict_with_std(&self, x: MatRef<'_, f64>) -> Result<(Mat<f64>, Mat<f64>)> {
        check::length("rows of x", self.inputs(), x.nrows())?;
        let (m, samples) = (self.outputs(), x.ncols());
        let (mut mean, mut std) = (Mat::zeros(m, samples), Mat::zeros(m, samples));
        let (mut scratch, mut sample) = (Scratch::default(), Vec::with_capacity(x.nrows()));
        for t in 0..samples {
            sample.clear();
            sample.extend(x.col(t).iter());
            let (mean, std) = (mean.col_as_slice_mut(t), std.col_as_slice_mut(t));
            self.predict_into(&sample, &mut scratch, mean, std).map_err(|error| error.at(t))?;
        }
        Ok((mean, std))
    }
}
