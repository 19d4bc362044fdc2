//! What can be wrong with a file.

/// The result of this crate's fallible calls.
pub type Result<T> = std::result::Result<T, Error>;

/// What is wrong with a file; each message says where, and what to do.
#[non_exhaustive]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A camera contradicts itself.
    #[error(transparent)]
    Camera(#[from] phalanx_camera::Error),
}
