//! The scale of a shape.

use crate::error::{Error, Result};
use crate::limits::MIN_MEAN_DISTANCE;
use crate::pairs;
use crate::points::Columns;

/// The mean distance μ over all pairs of the points, in pixels: the scale of their shape contexts.
///
/// # Errors
/// Too few or too many points, a coordinate out of range, or all points in one place.
///
/// ```
/// // The three sides of a triangle.
/// let mean = phalanx_shape_context::mean_distance(&[[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]])?;
/// assert!((mean - 4.0).abs() < 1e-12);
/// # Ok::<(), phalanx_shape_context::Error>(())
/// ```
pub fn mean_distance(points: &[[f64; 2]]) -> Result<f64> {
    let mut columns = Columns::default();
    columns.load(points)?;
    mean_distance_of(&columns)
}

/// That of checked points.
pub(crate) fn mean_distance_of(columns: &Columns) -> Result<f64> {
    let n = columns.xs.len();
    let pairs = (n * (n - 1) / 2) as f64;
    let mean_distance = pairs::distance_sum(columns) / pairs;
    if mean_distance < MIN_MEAN_DISTANCE {
        return Err(Error::Coincident { mean_distance });
    }
    Ok(mean_distance)
}
