//! A fitted multilayer perceptron.

use crate::data::check;
use crate::data::scaler::StandardScaler;
use crate::error::{Error, Result};
use crate::model::parts::known;
use crate::model::regressor::Regressor;
use crate::model::scratch::Scratch;
use crate::transform::affine_map::AffineMap;

/// A multilayer perceptron, fitted by [`MlpTrainer`](crate::MlpTrainer): affine maps with z/(1 +
/// e⁻ᶻ) between them, and a standard deviation for each target that does not depend on the input.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "MlpParts", into = "MlpParts"))]
pub struct Mlp {
    parts: MlpParts,
}

/// What a [`Mlp`] is made of.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MlpParts {
    /// The affine maps in order, at least one. The last returns standardised targets.
    pub layers: Vec<AffineMap>,
    /// The mean of each target.
    pub mean: Vec<f64>,
    /// The standard deviation of each target; 0 for a constant one.
    pub scale: Vec<f64>,
    /// The standard deviation of each target's prediction; 0 where the samples do not tell it.
    pub std: Vec<f64>,
}

impl Mlp {
    /// Assembles a perceptron from its parts, which are validated.
    pub fn from_parts(parts: MlpParts) -> Result<Self> {
        for pair in parts.layers.windows(2) {
            check::length("inputs of a layer", pair[0].outputs(), pair[1].inputs())?;
        }
        let Some(last) = parts.layers.last() else {
            return Err(Error::Parts { field: "layers", problem: "are none" });
        };
        for (what, found) in [("means", &parts.mean), ("standard deviations", &parts.std)] {
            check::length(what, last.outputs(), found.len())?;
        }
        StandardScaler::from_parts(parts.mean.clone(), parts.scale.clone())?;
        if !parts.std.iter().all(|&std| check::usable(std) && std >= 0.0) {
            return Err(Error::Parts { field: "std", problem: "holds an unusable number" });
        }
        Ok(Self { parts })
    }

    /// The parts, borrowed.
    pub fn parts(&self) -> &MlpParts {
        &self.parts
    }
}

impl Regressor for Mlp {
    fn inputs(&self) -> usize {
        self.parts.layers[0].inputs()
    }

    fn outputs(&self) -> usize {
        self.parts.std.len()
    }

    fn predict_into(
        &self,
        x: &[f64],
        scratch: &mut Scratch,
        mean: &mut [f64],
        std: &mut [f64],
    ) -> Result<()> {
        check::answers(self.outputs(), mean, std)?;
        let Scratch { single, hidden, projected, .. } = scratch;
        let MlpParts { layers, .. } = &self.parts;
        layers[0].apply_into(x, single, hidden)?;
        for layer in &layers[1..] {
            for z in hidden.iter_mut() {
                *z /= 1.0 + (-*z).exp();
            }
            layer.apply_into(hidden, single, projected)?;
            std::mem::swap(hidden, projected);
        }
        let targets = self.parts.mean.iter().zip(&self.parts.scale);
        for (value, (z, (mean, scale))) in mean.iter_mut().zip(hidden.iter().zip(targets)) {
            *value = mean + scale * z;
        }
        std.iter_mut().zip(&self.parts.std).for_each(|(std, &own)| *std = known(own));
        Ok(())
    }
}

impl TryFrom<MlpParts> for Mlp {
    type Error = Error;

    fn try_from(parts: MlpParts) -> Result<Self> {
        Self::from_parts(parts)
    }
}

impl From<Mlp> for MlpParts {
    fn from(network: Mlp) -> Self {
        network.parts
    }
}
