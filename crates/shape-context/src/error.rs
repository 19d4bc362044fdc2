use crate::grid::BINS;
use crate::limits::{MAX_COORDINATE, MAX_MATCHED, MAX_POINTS, MIN_MEAN_DISTANCE, MIN_POINTS};

/// The result of everything here that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a contour cannot be described.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Fewer points than a shape needs.
    #[error("{points} contour points, of which at least {MIN_POINTS} are needed")]
    TooFewPoints {
        /// How many were given.
        points: usize,
    },
    /// More points than can be described in reasonable time: the work grows with their square.
    #[error("{points} contour points, of which at most {MAX_POINTS} are allowed")]
    TooManyPoints {
        /// How many were given.
        points: usize,
    },
    /// A coordinate that is not a number or lies outside ± [`MAX_COORDINATE`].
    #[error("point {point} is ({x}, {y}): not finite, or beyond ±{MAX_COORDINATE}")]
    BadPoint {
        /// Its index in the contour.
        point: usize,
        /// Its column.
        x: f64,
        /// Its row.
        y: f64,
    },
    /// The forearm's end, or where one of its sides begins, is not a number or lies outside
    /// ± [`MAX_COORDINATE`].
    #[error("the forearm's end is ({x}, {y}): not finite, or beyond ±{MAX_COORDINATE}")]
    BadForearmEnd {
        /// Its column.
        x: f64,
        /// Its row.
        y: f64,
    },
    /// All points lie in one place, so that there is no scale.
    #[error("the mean distance of the points is {mean_distance}, below {MIN_MEAN_DISTANCE}")]
    Coincident {
        /// The mean distance of all pairs.
        mean_distance: f64,
    },
    /// A point has nobody within twice the mean distance, so that its histogram is empty.
    #[error("point {point} has no other point within twice the mean distance, {mean_distance}")]
    Isolated {
        /// Its index in the contour.
        point: usize,
        /// The mean distance of all pairs.
        mean_distance: f64,
    },
    /// Every contour point lies on the forearm's end: there is no hand axis.
    #[error("every contour point lies on the forearm's end")]
    NoHandAxis,
    /// The forearm has no axis: its sides begin in one place, no contour point lies along one of
    /// them, or its direction is given as zero or as no number.
    #[error("the forearm has no axis: no contour points along both of its sides")]
    NoForearmAxis,
    /// A step along the contour that is not positive.
    #[error("a step of {step} along the contour is not positive")]
    BadStep {
        /// The step.
        step: f64,
    },
    /// The contour spreads alike in all directions (a circle, a square): no principal axis.
    #[error("the contour spreads alike in all directions and has no principal axis")]
    NoPrincipalAxis,
    /// The contour encloses nothing, so that its tangents cannot be told from their opposites.
    #[error("the contour encloses no area, so its tangents have no sense")]
    NoArea,
    /// All the neighbours of a point lie on it.
    #[error("point {point} has no tangent: its neighbours along the contour coincide with it")]
    NoTangent {
        /// Its index in the contour.
        point: usize,
    },
    /// A point lies on the centroid and so has no direction from it.
    #[error("point {point} lies on the centroid of the contour")]
    AtCentroid {
        /// Its index in the contour.
        point: usize,
    },
    /// Numbers that are not a whole number of contexts, none of them, or too many to be matched.
    #[error("{values} numbers do not make 1 to {MAX_MATCHED} contexts of {BINS} bins")]
    NotContexts {
        /// How many numbers were given.
        values: usize,
    },
    /// A height of a context that is negative or not finite.
    #[error("bin {bin} of context {context} is {value}: heights are finite and not negative")]
    BadHeight {
        /// The context's index.
        context: usize,
        /// The bin within it.
        bin: usize,
        /// The height found there.
        value: f32,
    },
}
