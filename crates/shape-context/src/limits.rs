//! What shapes may be.

/// The fewest points that make a shape.
pub const MIN_POINTS: usize = 3;

/// The most points accepted: time grows with their square (a second or so at this limit).
pub const MAX_POINTS: usize = 20_000;

/// The largest coordinate accepted, in pixels, so that no product of a few of them overflows.
pub const MAX_COORDINATE: f64 = 1e9;

/// The smallest mean distance, in pixels, that counts as an extent.
pub const MIN_MEAN_DISTANCE: f64 = 1e-9;

/// The most contexts that a shape may have to be matched: memory grows with the product of both
/// shapes', time with its root times that.
pub const MAX_MATCHED: usize = 4000;
