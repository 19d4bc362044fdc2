//! The fitted model that most fitters return.

pub(crate) mod cholesky_factor;
mod codegen;
mod gradient;
pub(crate) mod parts;
mod predict;
pub(crate) mod regressor;
pub(crate) mod report;
pub(crate) mod scratch;

use faer::MatRef;

use crate::error::Result;
use crate::model::parts::{Basis, ModelParts};

/// A fitted regressor from K inputs to m targets, with its uncertainty.
///
/// All fitters except [`MlpTrainer`](crate::MlpTrainer) return one: linear or Gaussian basis
/// columns, weights, the scaling of inputs and targets, and the posterior. If all columns were
/// pruned it predicts the mean, with the target's own standard deviation. For a target that is
/// constant over the samples, or a fit to a single sample, the deviation is infinite, never 0.
///
/// ```
/// use phalanx_rvm::{Model, Regressor, RelevanceVectorMachine, Scratch, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(2, 60, |i, t| ((t * (3 + i)) as f64 * 0.618).fract());
/// let y = Mat::from_fn(1, 60, |_, t| (x[(0, t)] - x[(1, t)]).exp());
/// let model = RelevanceVectorMachine::default().fit(x.as_ref(), y.as_ref())?.model;
///
/// // One sample, without allocating anything from the second on.
/// let mut scratch = Scratch::default();
/// let (mut mean, mut std) = ([0.0], [0.0]);
/// model.predict_into(&[0.2, 0.7], &mut scratch, &mut mean, &mut std)?;
/// assert!((mean[0] - (-0.5_f64).exp()).abs() < 0.1 && std[0] > 0.0);
///
/// // Taken apart into plain vectors, and put together again.
/// assert_eq!(Model::from_parts(model.clone().into_parts())?, model);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "ModelParts", into = "ModelParts"))]
pub struct Model {
    parts: ModelParts,
}

impl Model {
    /// Assembles a model from its parts, which are validated.
    pub fn from_parts(parts: ModelParts) -> Result<Self> {
        parts.check()?;
        Ok(Self { parts })
    }

    /// The model's parts.
    pub fn into_parts(self) -> ModelParts {
        self.parts
    }

    /// The model's parts, borrowed.
    pub fn parts(&self) -> &ModelParts {
        &self.parts
    }

    /// A model whose parts a fitter has just computed.
    pub(crate) fn trusted(parts: ModelParts) -> Self {
        debug_assert_eq!(parts.check(), Ok(()));
        Self { parts }
    }

    /// Indices of the inputs that the model reads, ascending. The others may hold anything.
    pub fn selected_features(&self) -> &[usize] {
        &self.parts.features
    }

    /// Indices of the training samples that are kernel centres; empty for a linear model.
    pub fn kept_samples(&self) -> &[usize] {
        match &self.parts.basis {
            Basis::Linear => &[],
            Basis::Gaussian { samples, .. } => samples,
        }
    }

    /// The weights, m×p, in the targets' units. A column belongs to a selected feature (linear) or
    /// to a kept sample (Gaussian).
    pub fn weights(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.parts.weights, self.parts.outputs, self.parts.size())
    }

    /// The distance along each selected feature, in its units, at which a Gaussian is e^(−½);
    /// `None` for a linear model.
    pub fn length_scales(&self) -> Option<Vec<f64>> {
        let Basis::Gaussian { beta, .. } = &self.parts.basis else { return None };
        let deviation = (2.0 * beta).sqrt().recip();
        Some(self.parts.feature_scales.iter().map(|scale| scale * deviation).collect())
    }

    /// Standard deviation of each target's noise, in its units. Infinite where the samples do not
    /// tell it: for a constant target, and for a single sample.
    pub fn noise(&self) -> Vec<f64> {
        self.parts.known_noise().collect()
    }
}

impl TryFrom<ModelParts> for Model {
    type Error = crate::error::Error;

    fn try_from(parts: ModelParts) -> Result<Self> {
        Self::from_parts(parts)
    }
}

impl From<Model> for ModelParts {
    fn from(model: Model) -> Self {
        model.into_parts()
    }
}
