//! The plain numbers of a model, and the check that they fit together.

use crate::data::check::{numbers, part};
use crate::error::Result;
use crate::model::cholesky_factor::CholeskyFactor;

/// Everything that a [`Model`](crate::Model) is made of, in plain vectors.
///
/// A model predicts, for target j,
///
/// > ȳⱼ + Σₖ Wⱼₖ (φₖ(z) − φ̄ₖ),  z = (x − mean) / scale over `features`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ModelParts {
    /// Length K of an input vector.
    pub inputs: usize,
    /// Length m of a target vector.
    pub outputs: usize,
    /// Indices of the inputs that are read, ascending.
    pub features: Vec<usize>,
    /// Training mean of each input read.
    pub feature_means: Vec<f64>,
    /// Training standard deviation of each input read, above 0.
    pub feature_scales: Vec<f64>,
    /// What the columns are.
    pub basis: Basis,
    /// Training mean φ̄ₖ of each of the p columns.
    pub column_means: Vec<f64>,
    /// W, m×p, column by column, in the targets' units.
    pub weights: Vec<f64>,
    /// ȳ, the training mean of each target.
    pub bias: Vec<f64>,
    /// Standard deviation of each target's noise, in its units; 0 where the samples do not tell it.
    pub noise: Vec<f64>,
    /// How uncertain the function is, relative to the noise.
    pub posterior: Posterior,
}

/// The basis functions that a model keeps.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Basis {
    /// The features themselves.
    Linear,
    /// φₖ(z) = exp(−β ‖z − cₖ‖²).
    Gaussian {
        /// Magnitude of β, above 0.
        beta: f64,
        /// Index of the training sample behind each centre.
        samples: Vec<usize>,
        /// Standardised centres, features×p, feature by feature (all centres' first feature
        /// first), the order in which a prediction reads them.
        centres: Vec<f64>,
    },
}

/// Variance of the function value, as a multiple of the noise variance.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Posterior {
    /// Gaussian over the weights: one covariance shared by all targets, or one per target. The
    /// multiple is ‖M φ‖² over centred columns φ.
    Weights(Vec<CholeskyFactor>),
    /// Gaussian process over all samples with prior variance noise/λ: it grows to the prior far
    /// from the samples. The multiple is (k̃(x,x) − ‖M k̃(x)‖²)/λ + 1/I for the centred kernel k̃.
    Process {
        /// M with MᵀM = (K̃ + λI)⁻¹.
        factor: CholeskyFactor,
        /// λ > 0.
        lambda: f64,
    },
}

impl ModelParts {
    /// The noise as predictions take it: infinite where the samples do not tell it.
    pub(crate) fn known_noise(&self) -> impl Iterator<Item = f64> + '_ {
        self.noise.iter().map(|&noise| known(noise))
    }

    /// Number of basis columns p.
    pub(crate) fn size(&self) -> usize {
        match &self.basis {
            Basis::Linear => self.features.len(),
            Basis::Gaussian { samples, .. } => samples.len(),
        }
    }

    /// Do all lengths, indices and ranges fit together?
    pub(crate) fn check(&self) -> Result<()> {
        let (read, p, m) = (self.features.len(), self.size(), self.outputs);
        let ascending = self.features.is_sorted_by(|a, b| a < b);
        part("features", "must be ascending", !ascending)?;
        let beyond = self.features.last().is_some_and(|&last| last >= self.inputs);
        part("features", "names an input that is not there", beyond)?;
        part("outputs", "must be at least 1", m == 0)?;
        numbers("feature_means", &self.feature_means, Some(read))?;
        numbers("feature_scales", &self.feature_scales, Some(read))?;
        let flat = self.feature_scales.iter().any(|&s| s <= 0.0);
        part("feature_scales", "must be above 0", flat)?;
        numbers("column_means", &self.column_means, Some(p))?;
        numbers("weights", &self.weights, m.checked_mul(p))?;
        numbers("bias", &self.bias, Some(m))?;
        numbers("noise", &self.noise, Some(m))?;
        part("noise", "must not be negative", self.noise.iter().any(|&s| s < 0.0))?;
        if let Basis::Gaussian { beta, centres, .. } = &self.basis {
            part("beta", "must be above 0 and finite", !(*beta > 0.0 && beta.is_finite()))?;
            numbers("centres", centres, read.checked_mul(p))?;
        }
        self.check_posterior(p, m)
    }

    fn check_posterior(&self, p: usize, m: usize) -> Result<()> {
        match &self.posterior {
            Posterior::Weights(factors) => {
                let count = factors.len();
                part("posterior", "needs one factor or one per output", count != 1 && count != m)?;
                factors.iter().try_for_each(|factor| factor.check(p))
            }
            Posterior::Process { factor, lambda } => {
                let bad = !(*lambda > 0.0 && lambda.is_finite());
                part("lambda", "must be above 0 and finite", bad)?;
                let linear = matches!(self.basis, Basis::Linear);
                part("posterior", "is a process, which needs Gaussian columns", linear)?;
                part("posterior", "must cover all columns", factor.columns.len() != p)?;
                part("posterior", "has no samples", p == 0)?;
                factor.check(p)
            }
        }
    }
}

/// A deviation, or infinity in place of 0: equal samples, or a single one, do not tell how far
/// others may lie.
pub(crate) fn known(deviation: f64) -> f64 {
    if deviation > 0.0 { deviation } else { f64::INFINITY }
}
