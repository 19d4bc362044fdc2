//! What cannot be rendered.

/// The result of this crate's fallible calls.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a picture could not be rendered.
#[non_exhaustive]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The camera contradicts itself.
    #[error(transparent)]
    Camera(#[from] phalanx_camera::Error),
    /// A solid has a number out of its range.
    #[error("primitive {index}: its {field} is out of range")]
    Primitive {
        /// Index of the solid in the slice.
        index: usize,
        /// What is out of range: `center`, `radius`, `thin_axis` or `flatness`.
        field: &'static str,
    },
    /// The background picture has another size than the camera's image.
    #[error("the background is {have:?}, the camera's image {want:?} px")]
    BackgroundSize {
        /// Width and height of the background, px.
        have: (u32, u32),
        /// Width and height of the camera's image, px.
        want: (u32, u32),
    },
    /// Outlines cannot be asked to be so far off.
    #[error("outlines may be 0.001 to 1 px off, not {found}")]
    Deviation {
        /// What was asked for, px.
        found: f64,
    },
    /// A number of an [`Appearance`](crate::Appearance) is out of its range.
    #[error("appearance: {field} is out of range")]
    Appearance {
        /// The field.
        field: &'static str,
    },
}
