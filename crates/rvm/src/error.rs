//! What can go wrong, by name.

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
    #[error("asked for {asked} columns of {available} that vary (at least 1)")]
    Count {
        /// Columns asked for.
        asked: usize,
        /// Columns there are.
        available: usize,
    },
    /// The square matrix over all basis columns would not fit an ordinary computer's memory.
    #[error("{columns} basis columns; this dense solver takes at most {limit}")]
    TooManyColumns {
        /// Basis columns of the problem.
        columns: usize,
        /// Most that are accepted.
        limit: usize,
    },
    /// A system is singular to working precision: a larger penalty is needed.
    #[error("the {size}×{size} system is singular to working precision; use a larger lambda")]
    Singular {
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
