use crate::encode::scratch::Scratch;
use crate::error::{Error, Result};

/// Something that turns any number of samples into a vector of fixed length, whatever their order.
///
/// ```
/// use phalanx_codebook::{Codebook, Encoder, Scratch, SoftHistogram, Vlad, SoftAssignment};
///
/// let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.0, 1.0], 2, 0.1)?;
/// let votes = SoftHistogram { codebook: &codebook, assignment: SoftAssignment::HARD };
/// let residuals = Vlad { codebook: codebook.clone() };
/// for (encoder, length) in [(&votes as &dyn Encoder, 2), (&residuals, 4)] {
///     let mut code = vec![0.0; encoder.dim()];
///     encoder.encode(&[0.9, 0.1, 0.2, 0.8], &mut Scratch::default(), &mut code)?;
///     assert_eq!(code.len(), length);
/// }
/// # Ok::<(), phalanx_codebook::Error>(())
/// ```
pub trait Encoder {
    /// The number of bins of a sample.
    fn bins(&self) -> usize;

    /// The length of the code.
    fn dim(&self) -> usize;

    /// The code of samples given one after the other, written to `out`.
    ///
    /// # Errors
    /// No samples, not a whole number of them, one that the encoder cannot compare, or an output of
    /// another length than [`dim`](Self::dim).
    fn encode(&self, samples: &[f32], scratch: &mut Scratch, out: &mut [f64]) -> Result<()>;
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
