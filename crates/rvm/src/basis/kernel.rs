//! Basis functions: the inputs themselves, or a Gaussian on every training sample.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::data::check;
use crate::data::size::ProblemSize;
use crate::error::{Error, Result};
use crate::linalg;

/// Most basis columns of a dense solver: one square matrix over them takes 0.8 GB.
const MOST_COLUMNS: usize = 10_000;

/// Basis functions f(x) of de Campos and Murray (2006), section 4, on standardised inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Kernel {
    /// f(x) = x: one basis column per input, so that sparsity selects features (p = K).
    Linear,
    /// φᵢ(x) = exp(−γ‖x − xᵢ‖²): one per training sample, so that sparsity selects samples (p = I).
    Gaussian(Bandwidth),
}

/// Bandwidth of a Gaussian kernel on standardised inputs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Bandwidth {
    /// Relative to the scatter of the training inputs: γ = c / (2 tr cov), where tr cov is the
    /// number of inputs that vary. c > 0. Use about 0.3 for few centres and many inputs, 1 to 3 for
    /// a centre on every sample, 5 to 10 for one or two inputs.
    Relative(f64),
    /// γ in exp(−γ‖x − xᵢ‖²), not zero. The sign is ignored, since the paper writes e^{β‖·‖²} with
    /// a negative β.
    Gamma(f64),
}

impl Bandwidth {
    /// |β| for standardised inputs of which `varying` vary.
    pub(crate) fn magnitude(self, varying: usize) -> f64 {
        match self {
            Self::Relative(c) => c / (2.0 * varying.max(1) as f64),
            Self::Gamma(gamma) => gamma.abs(),
        }
    }

    pub(crate) fn check(self) -> Result<()> {
        match self {
            Self::Relative(c) => check::positive("c", c),
            Self::Gamma(gamma) if gamma != 0.0 && gamma.is_finite() => Ok(()),
            Self::Gamma(value) => {
                Err(Error::Parameter { name: "gamma", value, requirement: "finite and not zero" })
            }
        }
    }
}

impl Kernel {
    pub(crate) fn check(self) -> Result<()> {
        match self {
            Self::Linear => Ok(()),
            Self::Gaussian(bandwidth) => bandwidth.check(),
        }
    }

    /// Number of basis columns over all inputs and samples, at most; an error where a dense solver
    /// does not take as many.
    pub(crate) fn columns(self, size: ProblemSize) -> Result<usize> {
        let columns = match self {
            Self::Linear => size.inputs,
            Self::Gaussian(_) => size.samples,
        };
        limited(columns)
    }
}

/// Refuses more columns than a dense solver takes.
pub(crate) fn limited(columns: usize) -> Result<usize> {
    if columns > MOST_COLUMNS {
        return Err(Error::TooManyColumns { columns, limit: MOST_COLUMNS });
    }
    Ok(columns)
}

/// Gaussian kernel between all pairs of columns of `z` (features × samples): exactly symmetric,
/// exactly 1 on the diagonal.
pub(crate) fn gaussian(z: MatRef<'_, f64>, beta: f64) -> Mat<f64> {
    let mut k = linalg::gram(z);
    let norms: Vec<f64> = (0..k.ncols()).map(|i| k[(i, i)]).collect();
    k.as_mut().par_col_iter_mut().enumerate().for_each(|(j, column)| {
        for (value, norm) in column.iter_mut().zip(&norms) {
            let squared = norm + norms[j] - 2.0 * *value;
            *value = (-beta * squared.max(0.0)).exp();
        }
    });
    k
}
