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

/// No bare arm is larger, in squares as wide as its wrist: up to the shoulder it is 12 of them long and, on average,
/// 1.6 wide.
const LARGEST_ARM: f64 = 20.0;

/// Whether what is behind the wrist may be an arm: behind a finger that is taken for a hand there is more.
pub(super) fn may_have_arm(hand: &HandDetection) -> bool {
    hand.behind <= LARGEST_ARM * hand.width * hand.width
}

impl Detections {
    /// Looks for hands in a camera's mask of any size. Those before more than an arm come last.
    pub fn find(camera: &Camera, mask: &Mask, finder: &mut HandDetector) -> Self {
        let (width, height) = mask.dimensions();
        let camera = camera.with_intrinsics(camera.intrinsics.resized(width, height));
        // What is no hand is an answer here, not an error: other views may see one.
        let found = finder.find(mask, &Cleanup::default(), WristModel::builtin());
        let mut hands = found.unwrap_or_default();
        // Other views can tell which end of an arm is which, so that any end counts alike here.
        hands.sort_by(|a, b| a.mahalanobis2.total_cmp(&b.mahalanobis2));
        hands.sort_by_key(|hand| !may_have_arm(hand));
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

#[cfg(test)]
mod tests {
    use phalanx_camera::Intrinsics;

    use super::*;

    #[test]
    fn a_rod_before_a_hand_comes_last() {
        let inside = Intrinsics::pinhole(160, 160, 150.0);
        let camera = Camera::look_at("above", inside, 500.0 * DVec3::Z, DVec3::ZERO, DVec3::Y)
            .expect("a camera");
        // A palm on an arm from below, and a thin rod that the palm touches.
        let mask = Mask::from_fn(160, 160, |x, y| {
            let (dx, dy) = (f64::from(x) - 79.5, f64::from(y) - 90.0);
            let palm = (dx / 22.0).powi(2) + (dy / 30.0).powi(2) < 1.0;
            let arm = dx.abs() < 12.0 && dy > 0.0;
            palm || arm || (dx.abs() < 2.5 && (-80.0..0.0).contains(&dy))
        });
        let mut finder = HandDetector::default();
        let all = finder.find(&mask, &Cleanup::default(), WristModel::builtin()).expect("hands");
        let is_rod = |hand: &HandDetection| hand.width < 10.0;
        assert!(all.iter().any(is_rod), "{all:?}");
        let kept = Detections::find(&camera, &mask, &mut finder).hands;
        assert!(!is_rod(&kept[0]) && kept.is_sorted_by_key(is_rod), "{kept:?}");
    }
}
