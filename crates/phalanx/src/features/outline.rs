//! The contour's points, whatever the camera's roll.

use phalanx_segmentation::Silhouette;
use phalanx_shape_context::{Chain, Error, ForearmAxis, forearm_axis, resample};

/// Distance of the points along the contour, pixels.
const STEP: f64 = 1.0;

pub(crate) fn chain(silhouette: &Silhouette) -> Chain {
    if silhouette.contour.is_closed() { Chain::Closed } else { Chain::Open }
}

/// The contour at equal steps, ahead of a cut squarely across the forearm.
///
/// Rolling the camera changes how densely pixels lie along each line, and lets the image border
/// cut the forearm obliquely, further out on one side than on the other. Neither is of the hand.
pub(crate) fn trace_outline(
    silhouette: &Silhouette,
    points: &mut Vec<[f64; 2]>,
) -> Result<ForearmAxis, Error> {
    points.clear();
    for piece in silhouette.contour.pieces() {
        resample(piece, chain(silhouette), STEP, points)?;
    }
    let axis = forearm_axis(points, silhouette.forearm.sides)?;
    points.retain(|&point| axis.is_ahead(point));
    Ok(axis)
}
