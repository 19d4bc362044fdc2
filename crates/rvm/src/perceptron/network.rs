//! A fitted perceptron.

use crate::{Error, Projection, Result, Scratch, check};

/// A fitted [`Perceptron`](crate::Perceptron): affine maps with z/(1 + e⁻ᶻ) between them, and a
/// standard deviation for each target, the same everywhere.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "NetworkParts", into = "NetworkParts"))]
pub struct Network {
    layers: Vec<Projection>,
    std: Vec<f64>,
}

/// What is stored.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct NetworkParts {
    layers: Vec<Projection>,
    std: Vec<f64>,
}

impl Network {
    /// Puts layers, at least one, together, and the standard deviations of the last one's outputs.
    pub fn from_parts(layers: Vec<Projection>, std: Vec<f64>) -> Result<Self> {
        for pair in layers.windows(2) {
            check::length("inputs of a layer", pair[0].outputs(), pair[1].inputs())?;
        }
        let Some(last) = layers.last() else {
            return Err(Error::Parts { field: "layers", problem: "are none" });
        };
        check::length("standard deviations", last.outputs(), std.len())?;
        if !std.iter().all(|&std| check::usable(std) && std >= 0.0) {
            return Err(Error::Parts { field: "std", problem: "holds an unusable number" });
        }
        Ok(Self { layers, std })
    }

    /// The layers, the first first.
    pub fn layers(&self) -> &[Projection] {
        &self.layers
    }

    /// The standard deviation of each target.
    pub fn std(&self) -> &[f64] {
        &self.std
    }

    /// Length K of an input.
    pub fn inputs(&self) -> usize {
        self.layers[0].inputs()
    }

    /// Number m of targets.
    pub fn outputs(&self) -> usize {
        self.std.len()
    }

    /// Mean and standard deviation of the m targets of one input `x` (length K), all finite.
    pub fn predict_into(
        &self,
        x: &[f64],
        scratch: &mut Scratch,
        mean: &mut [f64],
        std: &mut [f64],
    ) -> Result<()> {
        check::length("means", self.outputs(), mean.len())?;
        check::length("standard deviations", self.outputs(), std.len())?;
        let Scratch { single, hidden, projected, .. } = scratch;
        self.layers[0].apply_into(x, single, hidden)?;
        for layer in &self.layers[1..] {
            for z in hidden.iter_mut() {
                *z /= 1.0 + (-*z).exp();
            }
            layer.apply_into(hidden, single, projected)?;
            std::mem::swap(hidden, projected);
        }
        mean.copy_from_slice(hidden);
        std.copy_from_slice(&self.std);
        Ok(())
    }
}

impl TryFrom<NetworkParts> for Network {
    type Error = Error;

    fn try_from(parts: NetworkParts) -> Result<Self> {
        Self::from_parts(parts.layers, parts.std)
    }
}

impl From<Network> for NetworkParts {
    fn from(network: Network) -> Self {
        Self { layers: network.layers, std: network.std }
    }
}
