//! Photographs of hands that are drawn.

use anyhow::Result;
use image::RgbImage;
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{HandShape, Pose};
use phalanx_render::{Appearance, Renderer};

/// The photographs' size, px.
const SIZE: (u32, u32) = (320, 240);

/// The posed hand as one camera would photograph it.
///
/// # Errors
/// A camera that cannot draw.
pub(crate) fn photograph(
    camera: &Camera,
    hand: &HandShape,
    pose: &Pose,
    rig: &Rig,
    seed: u64,
) -> Result<RgbImage> {
    let camera = camera.with_intrinsics(camera.intrinsics.resized(SIZE.0, SIZE.1));
    let solids = hand.pose(pose, &rig.volume.rest_frame()).primitives;
    Ok(Renderer::new(&camera)?.shade(&solids, &Appearance::default(), seed)?)
}
