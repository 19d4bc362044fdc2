use serde::{Deserialize, Serialize};

use crate::{Codebook, Error, Result, Scratch, SoftCounts, Vlad, Voting};

/// Something that turns any number of samples into a vector of fixed length, whatever their order.
pub trait Coding {
    /// The number of bins of a sample.
    fn bins(&self) -> usize;

    /// The length of the code.
    fn dim(&self) -> usize;

    /// The code of samples given one after the other, written to `out`.
    ///
    /// # Errors
    /// No samples, not a whole number of them, one that is not a histogram that sums to 1, or an
    /// output of another length than [`dim`](Self::dim).
    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()>;
}

/// A coding of any kind, as it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum AnyCoding {
    /// Soft votes into the centres of a codebook: the paper's.
    Counts {
        /// The centres.
        codebook: Codebook,
        /// How samples vote.
        voting: Voting,
    },
    /// Residuals to the nearest centres.
    Vlad(Vlad),
}

impl Coding for AnyCoding {
    fn bins(&self) -> usize {
        match self {
            Self::Counts { codebook, .. } => codebook.dim(),
            Self::Vlad(vlad) => vlad.bins(),
        }
    }

    fn dim(&self) -> usize {
        match self {
            Self::Counts { codebook, .. } => codebook.len(),
            Self::Vlad(vlad) => vlad.dim(),
        }
    }

    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()> {
        match self {
            Self::Counts { codebook, voting } => {
                SoftCounts { codebook, voting: *voting }.encode(samples, scratch, out)
            }
            Self::Vlad(vlad) => vlad.encode(samples, scratch, out),
        }
    }
}

/// Refuses an output of another length than a code's.
pub(crate) fn check_length(out: &[f64], dim: usize) -> Result<()> {
    if out.len() == dim { Ok(()) } else { Err(Error::CodeLength { length: out.len(), dim }) }
}
