//! A multilayer perceptron on principal components.

use crate::data::check;
use crate::error::{Error, Result};
use crate::mlp::network::Mlp;
use crate::model::regressor::Regressor;
use crate::model::scratch::Scratch;
use crate::transform::block_pca::BlockPca;

/// A multilayer perceptron that reads principal components of the inputs.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Parts", into = "Parts"))]
pub struct PcaMlp {
    parts: Parts,
}

/// What is stored.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Parts {
    components: BlockPca,
    network: Mlp,
}

impl PcaMlp {
    /// Combines principal components with a perceptron that reads as many inputs.
    pub fn from_parts(components: BlockPca, network: Mlp) -> Result<Self> {
        check::length("inputs of the network", components.outputs(), network.inputs())?;
        Ok(Self { parts: Parts { components, network } })
    }

    /// The principal components.
    pub fn components(&self) -> &BlockPca {
        &self.parts.components
    }

    /// The perceptron.
    pub fn network(&self) -> &Mlp {
        &self.parts.network
    }
}

impl Regressor for PcaMlp {
    fn inputs(&self) -> usize {
        self.components().inputs()
    }

    fn outputs(&self) -> usize {
        self.network().outputs()
    }

    fn predict_into(
        &self,
        x: &[f64],
        scratch: &mut Scratch,
        mean: &mut [f64],
        std: &mut [f64],
    ) -> Result<()> {
        let mut z = std::mem::take(&mut scratch.components);
        let applied = self.components().apply_into(x, &mut scratch.single, &mut z);
        let predicted = applied.and_then(|()| self.network().predict_into(&z, scratch, mean, std));
        scratch.components = z;
        predicted
    }
}

impl TryFrom<Parts> for PcaMlp {
    type Error = Error;

    fn try_from(parts: Parts) -> Result<Self> {
        Self::from_parts(parts.components, parts.network)
    }
}

impl From<PcaMlp> for Parts {
    fn from(own: PcaMlp) -> Self {
        own.parts
    }
}
