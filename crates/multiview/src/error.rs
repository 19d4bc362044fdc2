//! What can be wrong with views and their codebooks.

/// An error of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A codebook could not be fitted or applied.
    #[error("view {view}: {reason}")]
    View {
        /// The view, from 0.
        view: usize,
        /// What its codebook says.
        reason: phalanx_codebook::Error,
    },
    /// There is no view at all.
    #[error("there is no view")]
    NoViews,
    /// Not as many views as there are codebooks.
    #[error("{found} views where there are codebooks for {expected}")]
    ViewCount {
        /// Views expected.
        expected: usize,
        /// Views given.
        found: usize,
    },
    /// A sample's view that is not a whole number of shape contexts.
    #[error("sample {sample}, view {view}: {values} numbers do not make shape contexts of {dim}")]
    Shape {
        /// The sample, from 0.
        sample: usize,
        /// Its view, from 0.
        view: usize,
        /// How many numbers were given.
        values: usize,
        /// How many a shape context has.
        dim: usize,
    },
    /// An output of the wrong length.
    #[error("the output has {found} numbers where the descriptor has {expected}")]
    OutputLength {
        /// Length of the joined descriptor.
        expected: usize,
        /// Length given.
        found: usize,
    },
}

/// A result of this crate.
pub type Result<T> = std::result::Result<T, Error>;
