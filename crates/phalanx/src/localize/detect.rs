//! What may be a hand in one camera's mask.

use glam::{DVec2, DVec3};
use phalanx_camera::Camera;
use phalanx_segmentation::{Cleanup, HandDetection, HandDetector, Mask, WristModel};

/// What a view costs in which no candidate is the hand: of 11 numbers of a wrist's shape, two of its
/// place, one of its width and one of the arm's direction, one in a thousand hands exceeds this squared
/// distance (χ² with 15 degrees of freedom).
pub(super) const LEFT_OUT: f64 = 37.7;

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

/// How much likelier one end of an arm can be than the other, as the logarithm of the odds: what a view shows is not
/// surer than that, and views whose masks err alike must not outvote the others.
const SUREST: f64 = 6.0;

/// An arm whose direction in a picture is shorter than this share of its length is seen from an end.
const FORESHORTENED: f64 = 0.5;

/// Cosine of the angle up to which a candidate's arm and that of a hand in space look alike.
const SIDEWAYS: f64 = 0.5;

/// How far ahead of the wrist it is looked where an arm points to in a picture, mm.
const AHEAD: f64 = 30.0;

/// How far from the wrist a candidate may be that is on the same arm, mm: a hand and a forearm.
const LIMB: f64 = 430.0;

/// Whether what is behind the wrist may be an arm: behind a finger that is taken for a hand there is more.
pub(super) fn may_have_arm(hand: &HandDetection) -> bool {
    hand.behind <= LARGEST_ARM * hand.width * hand.width
}

/// How little a candidate looks like a hand at this end of its arm: a squared distance in standard deviations. One that is
/// certainly at the other end is as unlikely as a view in which no candidate is the hand.
pub(crate) fn unlikely(hand: &HandDetection) -> f64 {
    let backwards = probability(-hand.ahead_log_odds);
    hand.mahalanobis2 + backwards * (LEFT_OUT - hand.mahalanobis2).max(0.0)
}

/// The probability that has these odds, given as their logarithm.
pub(crate) fn probability(log_odds: f64) -> f64 {
    (1.0 + (-log_odds).exp()).recip()
}

impl Detections {
    /// Looks for hands in a camera's mask of any size. Those before more than an arm come last.
    pub fn find(camera: &Camera, mask: &Mask, finder: &mut HandDetector) -> Self {
        let (width, height) = mask.dimensions();
        let camera = camera.with_intrinsics(camera.intrinsics.resized(width, height));
        // What is no hand is an answer here, not an error: other views may see one.
        let found = finder.find(mask, &Cleanup::default(), WristModel::builtin());
        let mut hands = found.unwrap_or_default();
        // Other views can tell which end of an arm is which.
        hands.sort_by(|a, b| unlikely(a).total_cmp(&unlikely(b)));
        hands.sort_by_key(|hand| !may_have_arm(hand));
        hands.truncate(MOST);
        Self { camera, hands, mask: mask.clone() }
    }

    /// Those of a camera that saw nothing.
    pub fn none(camera: &Camera) -> Self {
        Self { camera: camera.clone(), hands: Vec::new(), mask: Mask::default() }
    }

    /// How much likelier the hand is at the other end of the arm than where a hand in space has it, as the logarithm of the
    /// odds; nothing where the arm is seen from an end or this picture shows nothing there.
    pub(crate) fn backwards_log_odds(&self, wrist: DVec3, arm: DVec3) -> f64 {
        let ahead = AHEAD * arm;
        let (Some(at), Some(to)) = (self.camera.project(wrist), self.camera.project(wrist + ahead))
        else {
            return 0.0;
        };
        let depth = self.camera.extrinsics.to_camera(wrist).z.max(f64::MIN_POSITIVE);
        let scale = self.camera.intrinsics.fx / depth;
        let seen = to - at;
        if seen.length() < FORESHORTENED * AHEAD * scale {
            return 0.0;
        }
        let from = |hand: &HandDetection| DVec2::from_array(hand.wrist).distance(at);
        let along =
            |hand: &HandDetection| DVec2::from_array(hand.direction).dot(seen) / seen.length();
        let on_arm = self.hands.iter().filter(|hand| along(hand).abs() > SIDEWAYS);
        let nearest = on_arm.min_by(|a, b| from(a).total_cmp(&from(b)));
        match nearest.filter(|hand| from(hand) < LIMB * scale) {
            Some(hand) => -along(hand).signum() * hand.ahead_log_odds.clamp(-SUREST, SUREST),
            None => 0.0,
        }
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

    /// A camera 500 mm above the origin.
    fn above() -> Camera {
        let inside = Intrinsics::pinhole(160, 160, 150.0);
        Camera::look_at("above", inside, 500.0 * DVec3::Z, DVec3::ZERO, DVec3::Y).expect("a camera")
    }

    #[test]
    fn a_hand_is_likelier_ahead_of_its_wrist_than_at_its_sleeve() {
        // An open hand to the right, on an arm that ends within the picture.
        let mask = Mask::from_fn(160, 160, |x, y| {
            let (dx, dy) = (f64::from(x) - 90.0, (f64::from(y) - 80.0).abs());
            let arm = (-60.0..=0.0).contains(&dx) && dy < 8.5 - 0.05 * dx;
            let palm = (0.0..28.0).contains(&dx) && dy < (8.5 + 0.5 * dx).min(13.0);
            let fingers = (28.0..54.0).contains(&dx) && dy < 13.0 && (dy + 3.5) % 7.0 > 1.5;
            arm || palm || fingers
        });
        let camera = above();
        let on_table = |x: f64, y: f64| {
            let ray = camera.unproject(DVec2::new(x, y)).expect("a lens without distortion");
            ray.origin - ray.direction * (ray.origin.z / ray.direction.z)
        };
        let seen = Detections::find(&camera, &mask, &mut HandDetector::default());
        let wrist = on_table(90.0, 80.0);
        let along = (on_table(120.0, 80.0) - wrist).normalize();
        let right = seen.backwards_log_odds(wrist, along);
        assert!(right < -3.0, "{right}");
        assert_eq!(seen.backwards_log_odds(wrist, -along), -right);
        assert_eq!(seen.backwards_log_odds(on_table(75.0, 80.0), -along), -right);
        // Seen from its end an arm says nothing, and neither does an empty table.
        assert_eq!(seen.backwards_log_odds(wrist, DVec3::Z), 0.0);
        assert_eq!(Detections::none(&camera).backwards_log_odds(wrist, along), 0.0);
        let unlikely = |hand: &HandDetection| unlikely(hand) - hand.mahalanobis2;
        let is_right = |hand: &&HandDetection| hand.direction[0] > 0.7;
        let [own, other] =
            [true, false].map(|right| seen.hands.iter().find(|h| is_right(h) == right));
        let [own, other] = [own.expect("the hand"), other.expect("the sleeve")].map(unlikely);
        assert!(own < 3.0 && other > 10.0, "{own} {other}");
    }

    #[test]
    fn a_rod_before_a_hand_comes_last() {
        let camera = above();
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
