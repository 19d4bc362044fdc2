//! The posterior computed from scratch, against the rounding of many rank-one steps.

use faer::Mat;

use crate::error::{Error, Result};
use crate::linalg;
use crate::rvm::marginal_likelihood::active::Active;
use crate::rvm::marginal_likelihood::targets::Targets;

/// The posterior over the active columns.
pub(super) struct Posterior {
    /// M with Σ = MᵀM, lower triangular.
    pub(super) factor: Mat<f64>,
    /// Mean weights, active columns × m.
    pub(super) mu: Mat<f64>,
    /// yⱼᵀC⁻¹yⱼ.
    pub(super) misfit: Vec<f64>,
    pub(super) log_determinant: f64,
}

impl Posterior {
    /// From the active columns and their precisions.
    pub(super) fn of(active: &Active, targets: &Targets<'_>) -> Result<Self> {
        let (size, columns) = (active.len(), &active.columns);
        let d: Vec<f64> = active.alpha.iter().map(|a| a.sqrt().recip()).collect();
        let gram = linalg::subrows(active.gram.as_ref(), columns);
        let system = Mat::from_fn(size, size, |i, j| {
            let unit = if i == j { 1.0 } else { 0.0 };
            d[i] * gram[(i, j)] * d[j] + unit
        });
        let cholesky = linalg::cholesky(system).ok_or(Error::Singular { size })?;
        let mut factor = linalg::lower_inverse(cholesky.as_ref());
        for (j, d) in d.iter().enumerate() {
            factor.col_as_slice_mut(j).iter_mut().for_each(|v| *v *= d);
        }
        let correlations = linalg::subrows(targets.correlations, columns);
        let half = linalg::product(factor.as_ref(), correlations.as_ref());
        let mu = linalg::product(factor.transpose(), half.as_ref());
        let explained = half.col_iter().map(|column| column.squared_norm_l2());
        let misfit = targets.energies.iter().zip(explained).map(|(e, less)| (e - less).max(0.0));
        let misfit = misfit.collect();
        let log_determinant = (0..size).map(|i| 2.0 * cholesky[(i, i)].ln()).sum();
        Ok(Self { factor, mu, misfit, log_determinant })
    }
}
