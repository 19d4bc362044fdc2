//! What may be otherwise than it was given: the hand's proportions, where the cameras stand.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use phalanx_camera::{Camera, Extrinsics};
use phalanx_hand::HandShape;

/// How uncertain a hand's proportions are: standard deviations of logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapePrior {
    /// Of the hand's size.
    pub size: f64,
    /// Of how thick it is for its size: of all radii together.
    pub thickness: f64,
    /// Of every bone and radius.
    pub each: f64,
}

impl ShapePrior {
    /// The deviations of all numbers that describe such a hand: of its size, of its thickness, then of every bone
    /// and radius in the order of [`HandShape::scaled`].
    pub fn deviations(&self, hand: &HandShape) -> Vec<f64> {
        let mut deviations = vec![self.size, self.thickness];
        let _unchanged = hand.scaled(|| {
            deviations.push(self.each);
            1.0
        });
        deviations
    }
}

/// How uncertain it is where each camera stands, about and along each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtrinsicsPrior {
    /// Standard deviation of its turn about the middle of the volume, radians.
    pub turn: f64,
    /// Standard deviation of its shift, mm.
    pub shift: f64,
    /// Whether it stands elsewhere in every frame.
    pub motion: CameraMotion,
}

/// When cameras move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraMotion {
    /// They stand where they stand, if elsewhere than their calibration says.
    Static,
    /// From frame to frame.
    PerFrame,
}

/// When a hand and cameras are not believed to be as given, and how far off they may be.
///
/// Where the pose alone explains a boundary no better than to `above_rms_px`, the proportions of the hand
/// and the places of the cameras are fitted with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NuisanceParameters {
    /// Root of the mean (robust) squared distance of the boundaries, px.
    pub above_rms_px: f64,
    /// The hand.
    pub hand: Option<ShapePrior>,
    /// The cameras.
    pub cameras: Option<ExtrinsicsPrior>,
}

impl Default for NuisanceParameters {
    /// People's hands differ from the mean hand by some per cent, careful calibrations from the
    /// truth by a degree or two.
    fn default() -> Self {
        let turn = 1.2_f64.to_radians();
        Self {
            above_rms_px: 0.38,
            hand: Some(ShapePrior { size: 0.02, thickness: 0.02, each: 0.06 }),
            cameras: Some(ExtrinsicsPrior { turn, shift: 0.5, motion: CameraMotion::PerFrame }),
        }
    }
}

/// A camera that stands elsewhere sees what it would see, where it should stand, of a hand that is
/// moved the other way: this is how the hand seems moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ExtrinsicsCorrection {
    /// Scaled axis, radians.
    pub(crate) turn: DVec3,
    /// mm.
    pub(crate) shift: DVec3,
}

impl ExtrinsicsCorrection {
    pub(crate) const NONE: Self = Self { turn: DVec3::ZERO, shift: DVec3::ZERO };
    pub(crate) const NUMBERS: usize = 6;

    /// The motion of the hand, which turns about `pivot`.
    pub(crate) fn motion(&self, pivot: DVec3) -> DAffine3 {
        let rotation = DMat3::from_quat(DQuat::from_scaled_axis(self.turn));
        DAffine3::from_mat3_translation(rotation, pivot - rotation * pivot + self.shift)
    }

    /// The camera where it really stands.
    pub(crate) fn camera(&self, given: &Camera, pivot: DVec3) -> Camera {
        let motion = self.motion(pivot);
        let Extrinsics { rotation, translation } = given.extrinsics;
        let extrinsics = Extrinsics {
            rotation: rotation * motion.matrix3,
            translation: rotation * motion.translation + translation,
        };
        Camera { extrinsics, ..given.clone() }
    }

    /// The same after a step.
    pub(crate) fn stepped(&mut self, step: &[f64]) {
        self.turn += DVec3::from_slice(&step[..3]);
        self.shift += DVec3::from_slice(&step[3..]);
    }
}
