//! Errors.

/// Result of this crate's fallible calls.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a fit, a prediction or a load was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A matrix has no rows or no columns.
    #[error("{what} is empty: {rows}×{columns}")]
    Empty {
        /// Which matrix.
        what: &'static str,
        /// Its rows.
        rows: usize,
        /// Its columns (samples).
        columns: usize,
    },
    /// Two lengths that belong together differ.
    #[error("{what}: expected {expected}, found {found}")]
    Shape {
        /// Which length.
        what: &'static str,
        /// What it should be.
        expected: usize,
        /// What it is.
        found: usize,
    },
    /// An entry is NaN, infinite, or so large that its square overflows.
    #[error("{what}[{row}, {column}] is {value}; entries must be finite and below 1e150")]
    BadValue {
        /// Which matrix.
        what: &'static str,
        /// Row of the entry.
        row: usize,
        /// Column (sample) of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// A hyper-parameter lies outside its range.
    #[error("{name} = {value}: must be {requirement}")]
    Parameter {
        /// Field of the fitter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its range.
        requirement: &'static str,
    },
    /// A count of columns that is zero or more than there are.
    #[error("requested {requested} columns, but {available} are non-constant (at least 1)")]
    Count {
        /// Columns requested.
        requested: usize,
        /// Columns there are.
        available: usize,
    },
    /// The square matrix over all basis columns would not fit an ordinary computer's memory.
    #[error(
        "{columns} basis columns, one per sample (Gaussian kernel) or input (linear kernel); dense \
         solvers take at most {limit}: use fewer, or fit NystromRidge, which takes any number of \
         samples"
    )]
    TooManyColumns {
        /// Basis columns of the problem.
        columns: usize,
        /// Most that are accepted.
        limit: usize,
    },
    /// Indices of inputs or samples must be ascending and name what there is.
    #[error("{what}: index {index} does not ascend or is not below {available}")]
    Index {
        /// Which list.
        what: &'static str,
        /// The first index at fault.
        index: usize,
        /// How many there are to choose from.
        available: usize,
    },
    /// A streamed value is implausibly far from the pilot's samples.
    #[error(
        "{what}[{row}, {column}] is {value}, more than 65536 of the pilot's standard deviations \
         from its mean; draw the pilot at random from all samples, or remove the outlier"
    )]
    FarFromPilot {
        /// Which matrix.
        what: &'static str,
        /// Row of the entry.
        row: usize,
        /// Column (sample) of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// A target that is constant over the pilot varies in the stream, so that its scale is unknown.
    #[error(
        "{what}[{row}, {column}] is {value}, but row {row} is constant over the pilot; draw the \
         pilot at random from all samples"
    )]
    ConstantInPilot {
        /// Which matrix.
        what: &'static str,
        /// Row of the entry.
        row: usize,
        /// Column (sample) of the entry.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// Sums over so many samples could overflow.
    #[error("{samples} samples in one sum; the limit is {limit}")]
    TooManySamples {
        /// Samples that there would be.
        samples: usize,
        /// Most that are accepted.
        limit: usize,
    },
    /// Sums were combined with another basis, or with sums over another basis.
    #[error("the sums belong to basis {sums:016x}, not to basis {columns:016x}")]
    OtherColumns {
        /// Fingerprint of the columns that were summed.
        sums: u64,
        /// Fingerprint of the columns given.
        columns: u64,
    },
    /// The basis was made for another kernel than the fitter's.
    #[error("the fitter's kernel is {fitter}, but the basis has {columns}")]
    OtherKernel {
        /// Kernel of the fitter.
        fitter: String,
        /// Kernel of the columns.
        columns: String,
    },
    /// A name that is not a C identifier.
    #[error("{name:?} is no C identifier")]
    Identifier {
        /// The name.
        name: String,
    },
    /// Only a model with Gaussian columns and a posterior over weights can be augmented.
    #[error("only a model with Gaussian columns and a posterior over weights can be augmented")]
    NotSparse,
    /// Only Gaussian kernels have length scales.
    #[error("a linear kernel has no length scales to optimise; use a Gaussian one")]
    NoWidth,
    /// The basis of a second pass reads a feature that the first pass did not select.
    #[error("the basis reads feature {feature}, which the first pass did not select")]
    NotSelected {
        /// The first such feature.
        feature: usize,
    },
    /// The parts of sums do not fit together.
    #[error("parts of sums: {field} {problem}")]
    SufficientStatisticsParts {
        /// The field at fault.
        field: &'static str,
        /// What is wrong with it.
        problem: &'static str,
    },
    /// A system is singular to working precision: a larger penalty is needed.
    #[error("the {size}×{size} system is singular to working precision; use a larger lambda")]
    Singular {
        /// Its size.
        size: usize,
    },
    /// The eigenvalues of a symmetric matrix could not be found.
    #[error("the eigenvalues of a {size}×{size} matrix do not converge")]
    Eigenvalues {
        /// Its size.
        size: usize,
    },
    /// The parts of a model do not fit together.
    #[error("model parts: {field} {problem}")]
    Parts {
        /// The field at fault.
        field: &'static str,
        /// What is wrong with it.
        problem: &'static str,
    },
}

impl Error {
    /// Names the sample in an error about one of its values.
    pub(crate) fn at(self, column: usize) -> Self {
        match self {
            Self::BadValue { what, row, value, .. } => Self::BadValue { what, row, column, value },
            other => other,
        }
    }
}
