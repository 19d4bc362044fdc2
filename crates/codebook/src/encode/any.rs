//! An encoder of any kind, as it is stored.

use serde::{Deserialize, Serialize};

use crate::codebook::Codebook;
use crate::encode::encoder::Encoder;
use crate::encode::fisher::Fisher;
use crate::encode::scratch::Scratch;
use crate::encode::soft_assignment::{SoftAssignment, SoftHistogram};
use crate::encode::vlad::Vlad;
use crate::error::Result;

/// An encoder of any kind, as it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum AnyEncoder {
    /// Votes into the centres of a codebook, hard or soft: the paper's.
    SoftHistogram {
        /// The centres.
        codebook: Codebook,
        /// How samples vote.
        assignment: SoftAssignment,
    },
    /// Residuals to the nearest centres.
    Vlad(Vlad),
    /// Derivatives of a mixture of Gaussians.
    Fisher(Fisher),
}

impl AnyEncoder {
    /// The codebook, of all but Fisher vectors.
    pub fn codebook(&self) -> Option<&Codebook> {
        match self {
            Self::SoftHistogram { codebook, .. } | Self::Vlad(Vlad { codebook }) => Some(codebook),
            Self::Fisher(_) => None,
        }
    }
}

impl Encoder for AnyEncoder {
    fn bins(&self) -> usize {
        match self {
            Self::SoftHistogram { codebook, .. } => codebook.dim(),
            Self::Vlad(vlad) => vlad.bins(),
            Self::Fisher(fisher) => fisher.bins(),
        }
    }

    fn dim(&self) -> usize {
        match self {
            Self::SoftHistogram { codebook, .. } => codebook.len(),
            Self::Vlad(vlad) => vlad.dim(),
            Self::Fisher(fisher) => fisher.dim(),
        }
    }

    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()> {
        match self {
            Self::SoftHistogram { codebook, assignment } => {
                SoftHistogram { codebook, assignment: *assignment }.encode(samples, scratch, out)
            }
            Self::Vlad(vlad) => vlad.encode(samples, scratch, out),
            Self::Fisher(fisher) => fisher.encode(samples, scratch, out),
        }
    }
}
