//! A drawn hand as a camera sees it, of which it is known where its wrist is.

use anyhow::Result;
use glam::{DAffine3, DVec2, DVec3};
use phalanx_camera::Camera;
use phalanx_hand::{HandShape, Pose};
use phalanx_render::Renderer;
use phalanx_segmentation::Mask;

/// A silhouette and what it is of, in pixels.
pub(super) struct DrawnHand {
    pub(super) mask: Mask,
    /// The joints, the wrist first, and the ends of the digits.
    pub(super) points: Vec<DVec2>,
    /// Along the forearm, towards the hand.
    pub(super) direction: DVec2,
}

impl DrawnHand {
    /// The hand in a pose as a camera sees it; nothing where it is not before the camera.
    pub(super) fn of(
        hand: &HandShape,
        pose: &Pose,
        rest: &DAffine3,
        camera: &Camera,
    ) -> Result<Option<Self>> {
        let posed = hand.pose(pose, rest);
        let points = posed.joints.into_iter().chain(posed.ends(hand));
        let points: Option<Vec<DVec2>> = points.map(|point| camera.project(point)).collect();
        let behind = camera.project(rest.transform_point3(DVec3::NEG_Z));
        let (Some(points), Some(behind)) = (points, behind) else { return Ok(None) };
        let mask = Mask::from(Renderer::new(camera)?.silhouette(&posed.primitives)?);
        let direction = (points[0] - behind).normalize();
        Ok(Some(Self { mask, points, direction }))
    }

    pub(super) fn wrist(&self) -> DVec2 {
        self.points[0]
    }

    /// From the wrist to the furthest end.
    pub(super) fn length(&self) -> f64 {
        self.points.iter().map(|point| point.distance(self.wrist())).fold(0.0, f64::max)
    }
}
