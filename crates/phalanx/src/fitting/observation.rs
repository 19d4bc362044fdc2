//! One frame as all cameras see it, and what it tells of a hand in space.

use glam::{DAffine3, DVec3};
use phalanx_camera::Camera;
use phalanx_hand::HandShape;
use phalanx_segmentation::{HandDetection, HandDetector, Mask};

use super::points::CameraPoints;
use super::take_frame::TakeFrame;

use crate::error::{Error, Result};
use crate::localize::{
    Arm, BoundingSphere, Detections, HandCrop, Placement, associate, probability,
};

/// Placements of a frame that are tried.
const PLACEMENTS: usize = 8;

/// Where the middle of a hand is ahead of its wrist, and how far from there a ball reaches that holds it
/// in any posture, both as shares of its length.
const MIDDLE: f64 = 0.42;
const REACH: f64 = 0.75;

/// How far such a ball may be off and still hold the hand with its fingers stretched out, as a share of its radius.
const SPARE: f64 = 1.0 - (1.0 - MIDDLE) / REACH;

/// How far behind the wrist an arm is taken to be known, as a share of the hand's length: half a palm's
/// width. Further back arms differ more from the mean arm, and end in sleeves.
const KNOWN_ARM: f64 = 0.2;

/// The ball that holds a hand of some length.
pub(super) fn ball_of(wrist: DVec3, arm: DVec3, length: f64) -> BoundingSphere {
    BoundingSphere { middle: wrist + arm * (MIDDLE * length), radius: REACH * length }
}

/// Whether one ball holds the hand that another is around, also stretched out.
pub(super) fn holds(one: BoundingSphere, other: BoundingSphere) -> bool {
    one.middle.distance(other.middle) < SPARE * one.radius
}

/// Whether most of a hand that another ball is around is in one.
pub(super) fn holds_most(one: BoundingSphere, other: BoundingSphere) -> bool {
    one.middle.distance(other.middle) < 0.5 * one.radius
}

/// The arm of a hand of some length as far as it is known.
pub(super) fn arm_of(wrist: DVec3, arm: DVec3, length: f64) -> Arm {
    Arm { cut: wrist - arm * (KNOWN_ARM * length), direction: arm }
}

/// The arm of a hand of some length and as much of its palm as is known of the arm behind the wrist: a
/// picture that reaches as far shows all of the fingers.
pub(super) fn palm_of(wrist: DVec3, arm: DVec3, length: f64) -> Arm {
    Arm { cut: wrist + arm * (KNOWN_ARM * length), direction: arm }
}

/// The hand with as much of its forearm as is known, and half its width more.
pub(super) fn fitted_hand(hand: &HandShape) -> HandShape {
    let mut fitted = hand.clone();
    let half_width = hand.forearm.half_widths_mm[0];
    fitted.forearm.length_mm = KNOWN_ARM * hand.length_mm() + half_width;
    fitted
}

/// A frame in which hands were looked for.
pub(super) struct Sight {
    views: Vec<View>,
    detections: Vec<Detections>,
    pub(super) placements: Vec<Placement>,
    /// What a detector saw, camera by camera.
    pub(super) points: Vec<Option<CameraPoints>>,
}

/// One camera's part of a frame.
struct View {
    finder: HandDetector,
    is_empty: bool,
}

impl Sight {
    /// Looks for hands in the masks of a frame, one for each camera, of any size.
    ///
    /// # Errors
    /// Another number of masks or landmarks than cameras.
    pub(super) fn of(cameras: &[Camera], frame: &TakeFrame) -> Result<Self> {
        let TakeFrame { masks, landmarks, .. } = frame;
        if masks.len() != cameras.len() {
            let cameras = cameras.iter().map(|camera| camera.name.clone()).collect();
            return Err(Error::PictureCount { cameras, found: masks.len() });
        }
        let (mut views, mut detections) = (Vec::new(), Vec::new());
        for (camera, mask) in cameras.iter().zip(masks) {
            let mut finder = HandDetector::default();
            let found = match mask {
                Some(mask) => Detections::find(camera, mask, &mut finder),
                None => Detections::none(camera),
            };
            views.push(View { finder, is_empty: found.hands.is_empty() });
            detections.push(found);
        }
        let placements = associate(&detections, PLACEMENTS);
        let points = CameraPoints::of(cameras, landmarks)?;
        Ok(Self { views, detections, placements, points })
    }

    /// How likely it is that the hand is at the other end of the arm than where a frame has it.
    pub(super) fn backwards(&self, frame: &DAffine3) -> f64 {
        let odds =
            |view: &Detections| view.backwards_log_odds(frame.translation, frame.matrix3.z_axis);
        let told = self.detections.iter().map(odds).filter(|odds| *odds != 0.0);
        let sum: f64 = told.clone().sum();
        if told.count() == 0 { 0.0 } else { probability(sum) }
    }

    /// What each view sees of a ball in space; `None` of a view without anything like a hand, or for
    /// which the ball is not before the camera.
    pub(super) fn crops(&self, ball: BoundingSphere) -> Vec<Option<HandCrop>> {
        let views = self.views.iter().zip(&self.detections);
        views.map(|(view, detections)| view.crop(detections, ball)).collect()
    }
}

impl View {
    /// What is seen of the ball.
    fn crop(&self, detections: &Detections, ball: BoundingSphere) -> Option<HandCrop> {
        if self.is_empty {
            return None;
        }
        let mut parts: Vec<&HandDetection> = Vec::new();
        for hand in &detections.hands {
            if parts.iter().all(|part| part.component != hand.component) {
                parts.push(hand);
            }
        }
        let alone = parts.into_iter().map(|part| self.finder.isolate(part));
        crop_of(&detections.camera, alone, ball)
    }
}

/// What a camera sees of a ball, from the components of its mask: the one that fills most of it, and those
/// that lie mostly within.
pub(super) fn crop_of(
    camera: &Camera,
    components: impl Iterator<Item = Mask>,
    ball: BoundingSphere,
) -> Option<HandCrop> {
    let crop = |mask: Mask| -> Option<(u32, bool, HandCrop)> {
        let crop = HandCrop::onto(camera, &mask, ball).ok()?;
        Some((crop.filled(), crop.holds_most_of(&mask), crop))
    };
    let mut crops: Vec<(u32, bool, HandCrop)> = components.filter_map(crop).collect();
    crops.sort_by_key(|(filled, ..)| std::cmp::Reverse(*filled));
    let mut crops = crops.into_iter();
    let (filled, _, mut whole) = crops.next()?;
    crops.filter(|(_, is_within, _)| *is_within).for_each(|(.., part)| whole.add(&part));
    (filled > 0).then_some(whole)
}
