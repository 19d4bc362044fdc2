//! What may be a hand in one camera's mask.

use glam::{DVec2, DVec3};
use phalanx_camera::Camera;
use phalanx_segmentation::{Cleanup, HandDetection, HandDetector, Mask, WristModel};

/// What may be a hand in one picture. All pixels are those of `camera`, which is the camera resized to
/// the picture, so that they cannot be taken for those of a picture of another size.
#[derive(Debug, Clone, PartialEq)]
pub struct Detections {
    /// The camera, its image as large as the picture that was looked at.
    pub camera: Camera,
    /// The candidates, the likeliest first; none where nothing is as large as a hand.
    pub hands: Vec<HandDetection>,
    /// The picture's mask: hand is over 127.
    mask: Mask,
}

/// The candidates of a view that are considered. Three wrists along an arm from either of its ends
/// are six.
const MOST: usize = 6;

impl Detections {
    /// Looks for hands in a camera's mask of any size.
    pub fn find(camera: &Camera, mask: &Mask, finder: &mut HandDetector) -> Self {
        let (width, height) = mask.dimensions();
        let camera = camera.with_intrinsics(camera.intrinsics.resized(width, height));
        // What is no hand is an answer here, not an error: other views may see one.
        let found = finder.find(mask, &Cleanup::default(), WristModel::builtin());
        let mut hands = found.unwrap_or_default();
        // Other views can tell which end of an arm is which, so that any end counts alike here.
        hands.sort_by(|a, b| a.mahalanobis2.total_cmp(&b.mahalanobis2));
        hands.truncate(MOST);
        Self { camera, hands, mask: mask.clone() }
    }

    /// Those of a camera that saw nothing.
    pub fn none(camera: &Camera) -> Self {
        Self { camera: camera.clone(), hands: Vec::new(), mask: Mask::default() }
    }

    /// Whether a point of the world is seen within the mask.
    pub(super) fn covers(&self, point: DVec3) -> bool {
        let Some(pixel) = self.camera.project(point) else { return false };
        let (width, height) = self.mask.dimensions();
        let is_inside = pixel.cmpge(DVec2::ZERO).all()
            && pixel.x < f64::from(width)
            && pixel.y < f64::from(height);
        is_inside && self.mask.is_hand(pixel.x as u32, pixel.y as u32)
    }
}
