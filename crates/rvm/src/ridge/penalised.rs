//! Penalised least squares with a penalty of its own on each column.

use faer::{Mat, MatRef};

use crate::basis::normal_equations;
use crate::basis::normal_equations::Equations;
use crate::error::{Error, Result};
use crate::linalg;
use crate::model::Model;
use crate::model::cholesky_factor::CholeskyFactor;
use crate::model::parts::Posterior;

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
    /// Ridge regression: every column's penalty is λ.
    pub(crate) fn ridge(
        gram: MatRef<'_, f64>,
        correlations: MatRef<'_, f64>,
        lambda: f64,
    ) -> Result<Self> {
        Self::solve(gram, correlations, vec![lambda.sqrt().recip(); gram.ncols()])
    }

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

    /// M with Σ = MᵀM, the weights' covariance relative to the noise, and the degrees of freedom
    /// tr(G Σ) that the fit uses.
    pub(crate) fn posterior(&self) -> (Mat<f64>, f64) {
        // M = C⁻¹D, and tr(G Σ) = p − ‖C⁻¹‖².
        let mut factor = linalg::lower_inverse(self.cholesky.as_ref());
        let used = factor.ncols() as f64 - linalg::inner(factor.as_ref(), factor.as_ref());
        for (j, d) in self.scales.iter().enumerate() {
            factor.col_as_slice_mut(j).iter_mut().for_each(|v| *v *= d);
        }
        (factor, used)
    }

    /// The model on the columns `kept` of `equations`, which these weights belong to.
    pub(crate) fn model(&self, equations: &dyn Equations, kept: &[usize]) -> Model {
        let (factor, used) = self.posterior();
        let weights = self.weights.as_ref();
        let noise = noise(equations, kept, weights, used);
        let factor = CholeskyFactor::pack((0..kept.len()).collect(), factor.as_ref());
        normal_equations::model(equations, kept, weights, &noise, Posterior::Weights(vec![factor]))
    }
}

/// Each target's noise deviation: its residuals over the degrees of freedom that the penalised
/// fit, which uses `used`, and the bias leave. Where not even one is left the residuals say nothing,
/// and the noise is taken for the whole deviation of the target, which is 1.
pub(crate) fn noise(
    equations: &dyn Equations,
    kept: &[usize],
    weights: MatRef<'_, f64>,
    used: f64,
) -> Vec<f64> {
    let left = freedom(equations, used);
    let residuals = equations.residuals(kept, weights).into_iter();
    residuals.map(|squared| if left < 1.0 { 1.0 } else { (squared / left).sqrt() }).collect()
}

/// Degrees of freedom that a fit which uses `used`, and the bias, leave.
pub(crate) fn freedom(equations: &dyn Equations, used: f64) -> f64 {
    equations.samples() as f64 - 1.0 - used
}
