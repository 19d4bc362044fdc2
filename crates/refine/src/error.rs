//! What can go wrong.

/// An error of this crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A camera that contradicts itself.
    #[error(transparent)]
    Camera(#[from] phalanx_camera::Error),
    /// A hand that no one has.
    #[error(transparent)]
    Hand(#[from] phalanx_hand::Error),
    /// A hand that cannot be drawn.
    #[error("camera {camera}: {reason}")]
    Render {
        /// The camera.
        camera: String,
        /// Why.
        reason: phalanx_render::Error,
    },
    /// A mask of another size than the camera's image.
    #[error("camera {camera}: the silhouette is {}×{}, the image {}×{}", found.0, found.1, expected.0, expected.1)]
    MaskSize {
        /// The camera.
        camera: String,
        /// Width and height of the mask, px.
        found: (u32, u32),
        /// Width and height of the image, px.
        expected: (u32, u32),
    },
    /// A silhouette that is all hand or all background.
    #[error("camera {camera}: the silhouette has no boundary between hand and background")]
    NoBoundary {
        /// The camera.
        camera: String,
    },
    /// Landmarks none of which was seen.
    #[error("camera {camera}: none of its landmarks was seen")]
    NoLandmark {
        /// The camera.
        camera: String,
    },
    /// Nothing to fit to.
    #[error("neither a silhouette nor a landmark to fit to")]
    NoObservation,
    /// A number that is not finite.
    #[error("{what} {name} is {value}")]
    NotFinite {
        /// Of what.
        what: &'static str,
        /// Which one.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A prior whose precision matrix has the wrong size or is not symmetric and non-negative.
    #[error("the prior's precision {reason}")]
    Precision {
        /// What is wrong with it.
        reason: String,
    },
    /// A parameter out of its range.
    #[error("{name} is {value}, not {allowed}")]
    Parameter {
        /// Which one.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
    /// Frames that differ in their number of views.
    #[error("frame {frame} has {found} views, the first has {expected}")]
    ViewCount {
        /// The frame.
        frame: usize,
        /// How many it has.
        found: usize,
        /// How many the first has.
        expected: usize,
    },
}

/// A result of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;
