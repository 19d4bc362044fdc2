use crate::limits::{MAX_MAGNITUDE, SUM_TOLERANCE};

/// The result of everything here that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// Why something cannot be clustered, voted or loaded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting outside its range.
    #[error("{name} must be {must_be}")]
    Parameter {
        /// The setting's name.
        name: &'static str,
        /// Its range.
        must_be: &'static str,
    },
    /// No histogram where at least one is needed.
    #[error("no {what}s")]
    Empty {
        /// "sample" or "centre".
        what: &'static str,
    },
    /// Numbers that are not a whole number of histograms.
    #[error("{values} numbers do not make {what}s of dimension {dim}")]
    Shape {
        /// "sample" or "centre".
        what: &'static str,
        /// How many numbers were given.
        values: usize,
        /// The dimension they should have.
        dim: usize,
    },
    /// A height that is negative or not finite.
    #[error("bin {bin} of {what} {index} is {value}: heights are finite and not negative")]
    BadHeight {
        /// "sample" or "centre".
        what: &'static str,
        /// The histogram's index.
        index: usize,
        /// The bin within it.
        bin: usize,
        /// The height found there.
        value: f32,
    },
    /// A number of a vector that is not finite, or too large to be squared.
    #[error("number {bin} of {what} {index} is {value}: not finite, or beyond ±{MAX_MAGNITUDE}")]
    BadNumber {
        /// "sample", "centre", "mean" or "variance".
        what: &'static str,
        /// The vector's index.
        index: usize,
        /// The number within it.
        bin: usize,
        /// What was found there.
        value: f32,
    },
    /// A histogram that does not sum to 1.
    #[error("{what} {index} sums to {sum}, not to 1 within {SUM_TOLERANCE}")]
    NotNormalised {
        /// "sample" or "centre".
        what: &'static str,
        /// The histogram's index.
        index: usize,
        /// Its sum.
        sum: f64,
    },
    /// Weights of a mixture that are not positive, or do not sum to 1.
    #[error("the weights, whose sum is {sum}, are not positive numbers with a sum of 1")]
    BadWeights {
        /// Their sum.
        sum: f64,
    },
    /// A scale that is not a finite positive number.
    #[error("the scale is {scale}, which is not finite and positive")]
    BadScale {
        /// The scale given.
        scale: f64,
    },
    /// Fewer different samples than centres: no clustering has that many.
    #[error("{distinct} different samples cannot make {centres} centres")]
    TooFewDistinct {
        /// How many different samples there are.
        distinct: usize,
        /// How many centres are wanted.
        centres: usize,
    },
    /// More neighbours than centres, or none.
    #[error("{neighbours} neighbours among {centres} centres")]
    Neighbours {
        /// How many were asked for.
        neighbours: usize,
        /// How many centres there are.
        centres: usize,
    },
    /// An output of the wrong length.
    #[error("an output of length {length} for {centres} centres")]
    OutputLength {
        /// The output's length.
        length: usize,
        /// How many centres there are.
        centres: usize,
    },
    /// An output of another length than the code's.
    #[error("an output of length {length} for a code of {dim} numbers")]
    CodeLength {
        /// The output's length.
        length: usize,
        /// The code's.
        dim: usize,
    },
}
