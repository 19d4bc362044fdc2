//! What samples may be.

/// How far the sum of a histogram may be from 1.
pub const SUM_TOLERANCE: f64 = 1e-3;

/// The largest magnitude of a number, so that sums of squares stay finite.
pub const MAX_MAGNITUDE: f32 = 1e15;
