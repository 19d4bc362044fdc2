//! The posterior computed from scratch, against the rounding of many rank-one steps.

use faer::Mat;

use crate::error::{Error, Result};
use crate::linalg;
use crate::rvm::marginal_likelihood::Evidence;

/// The posterior over the active columns.
pub(super) struct Posterior {
    /// M with Σ = MᵀM, lower triangular.
    pub(super) factor: Mat<f64>,
    /// Mean weights, active columns × m.
    pub(super) mu: Mat<f64>,
    /// yⱼᵀC⁻¹yⱼ.
    misfit: Vec<f64>,
    log_determinant: f64,
}

impl Evidence<'_> {
    pub(super) fn posterior(&self) -> Result<Posterior> {
        let (size, columns) = (self.active.len(), &self.active.columns);
        let d: Vec<f64> = self.active.alpha.iter().map(|a| a.sqrt().recip()).collect();
        let gram = linalg::subrows(self.active.gram.as_ref(), columns);
        let system = Mat::from_fn(size, size, |i, j| {
            let unit = if i == j { 1.0 } else { 0.0 };
            d[i] * gram[(i, j)] * d[j] + unit
        });
        let cholesky = linalg::cholesky(system).ok_or(Error::Singular { size })?;
        let mut factor = linalg::lower_inverse(cholesky.as_ref());
        for (j, d) in d.iter().enumerate() {
            factor.col_as_slice_mut(j).iter_mut().for_each(|v| *v *= d);
        }
        let correlations = linalg::subrows(self.targets.correlations, columns);
        let half = linalg::product(factor.as_ref(), correlations.as_ref());
        let mu = linalg::product(factor.transpose(), half.as_ref());
        let explained = half.col_iter().map(|column| column.squared_norm_l2());
        let misfit =
            self.targets.energies.iter().zip(explained).map(|(e, less)| (e - less).max(0.0));
        let misfit = misfit.collect();
        let log_determinant = (0..size).map(|i| 2.0 * cholesky[(i, i)].ln()).sum();
        Ok(Posterior { factor, mu, misfit, log_determinant })
    }

    /// Computes everything anew from the active columns and their precisions.
    pub(super) fn refresh(&mut self) -> Result<()> {
        let Posterior { factor, mu, misfit, log_determinant } = self.posterior()?;
        let gram = self.targets.gram;
        for (k, s) in self.sparsity.iter_mut().enumerate() {
            *s = gram[(k, k)];
        }
        let overlap = linalg::times_upper(self.active.gram.as_ref(), factor.transpose());
        for column in overlap.col_iter() {
            self.sparsity.iter_mut().zip(column.iter()).for_each(|(s, c)| *s -= c * c);
        }
        self.quality =
            self.targets.correlations - linalg::product(self.active.gram.as_ref(), mu.as_ref());
        self.active.sigma = linalg::gram(factor.as_ref());
        self.active.mu = mu.transpose().to_owned();
        self.misfit = misfit;
        self.log_determinant = log_determinant;
        self.stale = 0;
        Ok(())
    }
}
