//! The estimated hand drawn again, beside what was seen.

use glam::DAffine3;
use phalanx_camera::Camera;
use phalanx_hand::{HandShape, Pose};
use phalanx_render::Renderer;
use phalanx_segmentation::Mask;

use crate::error::Result;
use crate::estimator::observation::{Observation, ObservedView};

/// How much of a posed hand and of what a view shows is common to both: intersection over union, 0 to 1; 0
/// in a view in which the hand cannot be drawn. There is one for each view of the observation.
///
/// # Errors
/// A camera without a window of the working size's shape.
pub(crate) fn overlaps(
    cameras: &[Camera],
    hand: &HandShape,
    rest: &DAffine3,
    pose: &Pose,
    observation: &Observation,
) -> Result<Vec<f64>> {
    let solids = hand.pose(pose, rest).primitives;
    let overlap = |view: &ObservedView| {
        let camera = view.seeing(&cameras[view.camera])?;
        let drawn = Renderer::new(&camera).and_then(|mut renderer| renderer.silhouette(&solids));
        Ok(drawn.map_or(0.0, |drawn| view.silhouette.mask.iou(&Mask::from(drawn))))
    };
    observation.views.iter().map(overlap).collect()
}
