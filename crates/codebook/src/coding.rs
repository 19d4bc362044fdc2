use serde::{Deserialize, Serialize};

use crate::{Codebook, Error, Fisher, Result, Scratch, SoftCounts, Vlad, Voting};

/// Something that turns any number of samples into a vector of fixed length, whatever their order.
///
/// ```
/// use phalanx_codebook::{Codebook, Coding, Scratch, SoftCounts, Vlad, Voting};
///
/// let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.0, 1.0], 2, 0.1)?;
/// let votes = SoftCounts { codebook: &codebook, voting: Voting::HARD };
/// let residuals = Vlad { codebook: codebook.clone() };
/// for (coding, length) in [(&votes as &dyn Coding, 2), (&residuals, 4)] {
///     let mut code = vec![0.0; coding.dim()];
///     coding.encode(&[0.9, 0.1, 0.2, 0.8], &mut Scratch::default(), &mut code)?;
///     assert_eq!(code.len(), length);
/// }
/// # Ok::<(), phalanx_codebook::Error>(())
/// ```
pub trait Coding {
    /// The number of bins of a sample.
    fn bins(&self) -> usize;

    /// The length of the code.
    fn dim(&self) -> usize;

    /// The code of samples given one after the other, written to `out`.
    ///
    /// # Errors
    /// No samples, not a whole number of them, one that the coding cannot compare, or an output of another length than [`dim`](Self::dim).
    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()>;
}

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

/// Refuses an output of another length than a code's.
pub(crate) fn check_length(out: &[f64], dim: usize) -> Result<()> {
    if out.len() == dim { Ok(()) } else { Err(Error::CodeLength { length: out.len(), dim }) }
}

/// Signed roots, brought to length 1. Samples are of f32, so that sums below its rounding are
/// rounding themselves.
pub(crate) fn normalise(code: &mut [f64]) {
    let squared: f64 = code.iter().map(|value| value.abs()).sum();
    let length = squared.sqrt();
    for value in code {
        let root = value.abs().sqrt().copysign(*value);
        *value = if squared > f64::from(f32::EPSILON) { root / length } else { 0.0 };
    }
}
