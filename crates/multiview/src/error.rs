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
    /// The codebook of all views together could not be fitted or applied.
    #[error("all views: {0}")]
    Pooled(phalanx_codebook::Error),
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
    /// A view's estimate, or its deviations, of another length than the first view's estimate.
    #[error("view {view} has {found} numbers for {expected} outputs")]
    EstimateLength {
        /// The view, from 0.
        view: usize,
        /// Length of the first view's estimate.
        expected: usize,
        /// Length given.
        found: usize,
    },
    /// An estimate or a deviation that is not finite.
    #[error("view {view}, output {output}: {value} is no number to join")]
    Estimate {
        /// The view, from 0.
        view: usize,
        /// The output, from 0.
        output: usize,
        /// What was given.
        value: f64,
    },
    /// A deviation below 0.
    #[error("view {view}, output {output}: {value} is no standard deviation")]
    Deviation {
        /// The view, from 0.
        view: usize,
        /// The output, from 0.
        output: usize,
        /// What was given.
        value: f64,
    },
}

/// A result of this crate.
pub type Result<T> = std::result::Result<T, Error>;
