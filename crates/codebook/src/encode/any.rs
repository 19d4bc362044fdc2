//! An encoder of any kind, as it is stored.

use serde::{Deserialize, Serialize};

use crate::codebook::Codebook;
use crate::encode::encoder::Coding;
use crate::encode::fisher::Fisher;
use crate::encode::scratch::Scratch;
use crate::encode::soft_assignment::{SoftCounts, Voting};
use crate::encode::vlad::Vlad;
use crate::error::Result;

/// A coding of any kind, as it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum AnyCoding {
    /// Votes into the centres of a codebook, hard or soft: the paper's.
    Counts {
        /// The centres.
        codebook: Codebook,
        /// How samples vote.
        voting: Voting,
    },
    /// Residuals to the nearest centres.
    Vlad(Vlad),
    /// Derivatives of a mixture of Gaussians.
    Fisher(Fisher),
}

impl Coding for AnyCoding {
    fn bins(&self) -> usize {
        match self {
            Self::Counts { codebook, .. } => codebook.dim(),
            Self::Vlad(vlad) => vlad.bins(),
            Self::Fisher(fisher) => fisher.bins(),
        }
    }

    fn dim(&self) -> usize {
        match self {
            Self::Counts { codebook, .. } => codebook.len(),
            Self::Vlad(vlad) => vlad.dim(),
            Self::Fisher(fisher) => fisher.dim(),
        }
    }

    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()> {
        match self {
            Self::Counts { codebook, voting } => {
                SoftCounts { codebook, voting: *voting }.encode(samples, scratch, out)
            }
            Self::Vlad(vlad) => vlad.encode(samples, scratch, out),
            Self::Fisher(fisher) => fisher.encode(samples, scratch, out),
        }
    }
}
