//! Penalised least squares with a penalty of its own on each column.

use faer::{Mat, MatRef};

use crate::model::{Factor, Posterior};
use crate::problem::Design;
use crate::{Error, Model, Result, linalg};

/// The minimiser of ‖Y − ΦW‖² + Σₖ ‖wₖ‖²/dₖ².
///
/// Solved as W = D (D G D + I)⁻¹ D B with D = diag(d): where a dₖ goes to zero the system stays
/// well conditioned and the weight goes to zero, while G + D⁻² becomes singular to working
/// precision.
pub(crate) struct Penalised {
    /// Weights, p×m.
    pub(crate) weights: Mat<f64>,
    /// C with C Cᵀ = D G D + I.
    cholesky: Mat<f64>,
    scales: Vec<f64>,
}

impl Penalised {
    /// From G (p×p), B (p×m) and the scales d (p).
    pub(crate) fn solve(
        gram: MatRef<'_, f64>,
        correlations: MatRef<'_, f64>,
        scales: Vec<f64>,
    ) -> Result<Self> {
        let p = scales.len();
        let d = &scales;
        let system = Mat::from_fn(p, p, |i, j| {
            let unit = if i == j { 1.0 } else { 0.0 };
            d[i] * gram[(i, j)] * d[j] + unit
        });
        let cholesky = linalg::cholesky(system).ok_or(Error::Singular { size: p })?;
        let mut weights = Mat::from_fn(p, correlations.ncols(), |i, j| d[i] * correlations[(i, j)]);
        linalg::cholesky_solve(cholesky.as_ref(), &mut weights);
        for j in 0..weights.ncols() {
            weights.col_as_slice_mut(j).iter_mut().zip(d).for_each(|(w, d)| *w *= d);
        }
        Ok(Self { weights, cholesky, scales })
    }

    /// The model on the columns `kept` of `design`, with each target's noise estimated from its
    /// residuals over the degrees of freedom that the penalised fit and the bias leave.
    pub(crate) fn model(&self, design: &Design<'_>, kept: &[usize]) -> Model {
        let columns =
            Mat::from_fn(design.columns.nrows(), kept.len(), |i, k| design.columns[(i, kept[k])]);
        let fitted = linalg::product(columns.as_ref(), self.weights.as_ref());
        let residuals = design.targets() - &fitted;
        // With M = C⁻¹D the weights' covariance relative to the noise is Σ = MᵀM, and the fit uses
        // tr(G Σ) = p − ‖C⁻¹‖² degrees of freedom.
        let mut factor = linalg::lower_inverse(self.cholesky.as_ref());
        let used = kept.len() as f64 - linalg::inner(factor.as_ref(), factor.as_ref());
        for (j, d) in self.scales.iter().enumerate() {
            factor.col_as_slice_mut(j).iter_mut().for_each(|v| *v *= d);
        }
        let left = (residuals.nrows() as f64 - 1.0 - used).max(1.0);
        let noise: Vec<f64> = (0..residuals.ncols())
            .map(|j| (residuals.col(j).iter().map(|r| r * r).sum::<f64>() / left).sqrt())
            .collect();
        let posterior =
            Posterior::Weights(vec![Factor::pack((0..kept.len()).collect(), factor.as_ref())]);
        design.model(kept, self.weights.as_ref(), &noise, posterior)
    }
}

impl Factor {
    /// Packs a lower triangular matrix over `columns`.
    pub(crate) fn pack(columns: Vec<usize>, lower: MatRef<'_, f64>) -> Self {
        let n = columns.len();
        let packed = (0..n).flat_map(|j| (j..n).map(move |i| lower[(i, j)])).collect();
        Self { columns, packed }
    }
}
