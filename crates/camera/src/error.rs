//! What can be wrong with a camera, a volume or a rig.

use glam::{DVec2, DVec3};

/// The result of this crate's fallible calls.
pub type Result<T> = std::result::Result<T, Error>;

/// What is wrong with a camera, a volume or a rig; each message names the camera and the field.
#[non_exhaustive]
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The text is not TOML, or has unknown, missing or ill-typed keys.
    #[error("rig file: {message}")]
    Toml {
        /// The line at fault, and the parser's message.
        message: String,
    },
    /// A number of distortion coefficients that no lens model has.
    #[error(
        "camera `{camera}`: {found} distortion coefficients: OpenCV's are 4, 5, 8, 12 or 14, and a \
         fisheye's 4"
    )]
    DistortionCount {
        /// The camera.
        camera: String,
        /// How many there are.
        found: usize,
    },
    /// A virtual camera's two directions do not make axes.
    #[error("camera `{camera}`: cannot be turned to {ahead} with {right} to the right")]
    VirtualAxis {
        /// The camera.
        camera: String,
        /// Where it should look.
        ahead: DVec3,
        /// What should be to the right.
        right: DVec3,
    },
    /// One ray, or none, determines no point.
    #[error("{found} rays are too few to triangulate: at least 2 are needed")]
    TooFewRays {
        /// How many there are.
        found: usize,
    },
    /// Rays that are all but parallel, or not finite.
    #[error("the rays are parallel: no point is nearest to them")]
    ParallelRays,
    /// The rig has no camera.
    #[error("the rig has no camera")]
    NoCamera,
    /// Two cameras share a name.
    #[error("camera `{camera}`: two cameras have this name")]
    DuplicateName {
        /// The name.
        camera: String,
    },
    /// A camera's name cannot be a folder's name.
    #[error(
        "camera `{camera}`: a name is one or more letters, digits, `_`, `-` or `.`, \
         and does not begin with `.`"
    )]
    Name {
        /// The name.
        camera: String,
    },
    /// No camera of the rig has this name.
    #[error("no camera is called `{name}`; the rig has {}", names.join(", "))]
    UnknownCamera {
        /// The name asked for.
        name: String,
        /// The rig's names.
        names: Vec<String>,
    },
    /// A number is NaN, infinite or absurdly large.
    #[error("camera `{camera}`: {field} is not finite or far too large")]
    NotFinite {
        /// The camera.
        camera: String,
        /// The field, as a rig file calls it.
        field: &'static str,
    },
    /// An image side is zero or over [`Intrinsics::MAX_SIDE`](crate::Intrinsics::MAX_SIDE).
    #[error("camera `{camera}`: {width}×{height} px is not a usable width and height")]
    ImageSize {
        /// The camera.
        camera: String,
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
    },
    /// A focal length is not positive, or over
    /// [`Intrinsics::MAX_FOCAL`](crate::Intrinsics::MAX_FOCAL).
    #[error("camera `{camera}`: focal_px [{fx}, {fy}] is out of range")]
    FocalLength {
        /// The camera.
        camera: String,
        /// Along x, px.
        fx: f64,
        /// Along y, px.
        fy: f64,
    },
    /// The principal point lies outside the image. A single [`Camera`](crate::Camera) may have
    /// it there, when it is that of an image cropped off its middle; a rig's may not.
    #[error("camera `{camera}`: principal_point_px {point} lies outside the image")]
    PrincipalPoint {
        /// The camera.
        camera: String,
        /// The point, px.
        point: DVec2,
    },
    /// The distortion maps two directions to one pixel where the hand works. That it does so elsewhere
    /// in the image, where calibrations are extrapolated, is allowed; no direction is known there.
    #[error(
        "camera `{camera}`: its distortion folds over at {:.0}, {:.0} px, where the volume is seen: \
         calibrate with the board in all of the picture, or make the volume's size_mm smaller",
        pixel.x, pixel.y
    )]
    Folding {
        /// The camera.
        camera: String,
        /// Where it folds over, px.
        pixel: DVec2,
    },
    /// Neither, both or parts of the two ways to say where a camera stands.
    #[error(
        "camera `{camera}`: give either position_mm, look_at_mm and up, \
         or rotation and translation_mm"
    )]
    Pose {
        /// The camera.
        camera: String,
    },
    /// The camera stands at the point that it looks at.
    #[error("camera `{camera}`: look_at_mm is the same point as position_mm")]
    LookAtIsPosition {
        /// The camera.
        camera: String,
    },
    /// The camera's up is zero or along its view.
    #[error("camera `{camera}`: up is zero or parallel to the view")]
    UpAlongView {
        /// The camera.
        camera: String,
    },
    /// The rotation's columns are not orthogonal unit vectors.
    #[error("camera `{camera}`: rotation is not orthonormal, by {deviation:.2e}")]
    NotOrthonormal {
        /// The camera.
        camera: String,
        /// The largest element of |RᵀR − I|.
        deviation: f64,
    },
    /// The rotation mirrors (its determinant is −1).
    #[error("camera `{camera}`: rotation is a reflection")]
    Reflection {
        /// The camera.
        camera: String,
    },
    /// A field of the volume is NaN, infinite, zero or negative.
    #[error("volume: {field} is not finite, or not positive where it must be")]
    VolumeField {
        /// The field, as a rig file calls it.
        field: &'static str,
    },
    /// The volume's two directions are parallel.
    #[error("volume: up is parallel to forearm")]
    VolumeUpAlongForearm,
    /// A camera does not see the middle of the volume: it is behind the camera.
    #[error("camera `{camera}`: the volume's center_mm lies behind it")]
    VolumeBehind {
        /// The camera.
        camera: String,
    },
    /// A camera does not see the middle of the volume: it is beside the picture.
    #[error("camera `{camera}`: the volume's center_mm lies outside its picture")]
    VolumeOutside {
        /// The camera.
        camera: String,
    },
    /// A hand in the middle of the volume would be absurdly small or large in a camera's picture.
    #[error(
        "camera `{camera}`: a hand of 190 mm would be {px:.0} px long in its picture, {distance:.0} mm \
         away: is the unit of length right, and the volume's center_mm?"
    )]
    HandSize {
        /// The camera.
        camera: String,
        /// How long the hand would be, px.
        px: f64,
        /// From the camera to the middle of the volume, mm.
        distance: f64,
    },
    /// A window to crop to is empty or reaches beyond the image.
    #[error("the window {width}×{height} at ({x}, {y}) is not inside the image {image:?}")]
    Window {
        /// Left edge, px.
        x: u32,
        /// Top edge, px.
        y: u32,
        /// Width, px.
        width: u32,
        /// Height, px.
        height: u32,
        /// Width and height of the image, px.
        image: [u32; 2],
    },
}
