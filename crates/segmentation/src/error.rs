//! What can go wrong, by name.

use crate::masking::label::Label;

/// Result of this crate's fallible functions.
pub type Result<T> = std::result::Result<T, Error>;

/// Why there is no mask, silhouette or model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A side of the image is shorter than the operation needs.
    #[error("image is {width}×{height} pixels, each side needs at least {minimum}")]
    ImageTooSmall {
        /// Width found, in pixels.
        width: u32,
        /// Height found, in pixels.
        height: u32,
        /// Shortest side that is accepted, in pixels.
        minimum: u32,
    },
    /// Two images that belong together differ in size.
    #[error("{what} is {}×{} pixels, expected {}×{}", found.0, found.1, expected.0, expected.1)]
    SizeMismatch {
        /// The image at fault.
        what: &'static str,
        /// Width and height needed.
        expected: (u32, u32),
        /// Width and height found.
        found: (u32, u32),
    },
    /// No component of the mask is large enough to be a hand.
    #[error(
        "empty mask: the largest component has {pixels} pixels, a hand needs at least {needed}"
    )]
    EmptyMask {
        /// Pixels of the largest component that was left.
        pixels: usize,
        /// Pixels that were asked for.
        needed: usize,
    },
    /// The mask covers the whole image border, so that no contour is inside the image.
    #[error(
        "no contour: the mask covers the whole image border ({pixels} of {width}×{height} pixels are hand)"
    )]
    NoContour {
        /// Pixels in the mask.
        pixels: usize,
        /// Image width in pixels.
        width: u32,
        /// Image height in pixels.
        height: u32,
    },
    /// The silhouette crosses no border, and its ends are too alike to tell forearm from fingers.
    #[error(
        "no forearm: the silhouette crosses no image border and its ends look alike \
         (elongation {elongation:.2}, raggedness {:.1} and {:.1}, areas {} and {} pixels)",
        raggedness[0], raggedness[1], areas[0], areas[1]
    )]
    NoForearm {
        /// Ratio of the standard deviations along the two principal axes, at least 1.
        elongation: f64,
        /// Squared number of contour points per pixel of area at the two ends.
        raggedness: [f64; 2],
        /// Hand pixels at the two ends.
        areas: [usize; 2],
    },
    /// Nothing in the mask has a section that could be a wrist.
    #[error("no hand: no part of the mask is wide enough to have a wrist")]
    NoHand,
    /// Too few silhouettes to learn from.
    #[error("{found} silhouettes with a wrist to learn from, at least {needed} are needed")]
    TooFewWrists {
        /// How many there were.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Bytes that are not a wrist model.
    #[error("not a wrist model: line {line}: {reason}")]
    WristModel {
        /// Line at fault, counted from 1; 0 for the whole.
        line: usize,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// Bytes that are not a model of an arm's ends, or parts that make none.
    #[error("not a model of an arm's ends: {0}")]
    EndModel(&'static str),
    /// Nothing in the picture stands out from the wall.
    #[error(
        "no contrast: hand and wall differ by {difference:.1} grey levels, at least {needed} are needed"
    )]
    NoContrast {
        /// Difference of the two class means, in grey levels.
        difference: f64,
        /// Difference that is needed, in grey levels.
        needed: f64,
    },
    /// A background was asked for without a single frame.
    #[error("no background frames were given")]
    NoFrames,
    /// A class has no training pixel.
    #[error("no {0:?} pixel to train from")]
    NoTrainingPixels(Label),
    /// A parameter outside its range.
    #[error("{name} is {value}, it must be {allowed}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Value found.
        value: f64,
        /// What is accepted, in words.
        allowed: &'static str,
    },
    /// Bytes that are not a skin model.
    #[error("not a skin model: line {line}: {reason}")]
    Model {
        /// Line at fault, counted from 1.
        line: usize,
        /// What is wrong with it.
        reason: &'static str,
    },
}
