//! How large a hand is in a camera's picture.

use glam::{DMat2, DVec3};

use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::rig::Rig;

/// How a camera sees the middle of the volume.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewScale {
    /// The camera's name.
    pub camera: String,
    /// From the camera to the middle of the volume, mm.
    pub distance: f64,
    /// How long a millimetre across the view is, px.
    pub px_per_mm: f64,
}

impl ViewScale {
    /// Length of the hand by which scales are judged, mm: an adult's, from wrist to fingertip.
    pub const HAND_MM: f64 = 190.0;

    /// A finger's width, mm: narrower than a pixel, fingers are not seen apart.
    const FINGER_MM: f64 = 15.0;

    /// Of a hand that is so many times as long as the picture, not even one finger fits into it.
    const MOST_PICTURES: f64 = 4.0;

    /// How long a hand is in the picture, px.
    pub fn hand_px(&self) -> f64 {
        Self::HAND_MM * self.px_per_mm
    }
}

/// At which angle two cameras see the middle of the volume.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewAngle {
    /// One camera's name.
    pub first: String,
    /// The other's.
    pub second: String,
    /// Between their lines of sight, radians.
    pub angle: f64,
}

impl Camera {
    /// How long a millimetre across the line of sight is at a point of the world, px: the square root
    /// of how much area is enlarged. `None` where the point is not seen.
    ///
    /// ```
    /// use glam::DVec3;
    /// use phalanx_camera::{Camera, Intrinsics};
    ///
    /// let inside = Intrinsics::pinhole(640, 480, 600.0);
    /// let camera = Camera::look_at("c", inside, DVec3::Z * 300.0, DVec3::ZERO, DVec3::Y)?;
    /// assert!((camera.px_per_mm(DVec3::ZERO).expect("in view") - 2.0).abs() < 1e-5);
    /// # Ok::<(), phalanx_camera::Error>(())
    /// ```
    pub fn px_per_mm(&self, world: DVec3) -> Option<f64> {
        let ahead = world - self.centre();
        let step = 1e-3 * ahead.length();
        let (across, along) = ahead.try_normalize()?.any_orthonormal_pair();
        let from = |direction: DVec3| {
            let ends = [1.0, -1.0].map(|sign| self.project(world + direction * (sign * step)));
            Some((ends[0]? - ends[1]?) / (2.0 * step))
        };
        let enlarged = DMat2::from_cols(from(across)?, from(along)?).determinant();
        Some(enlarged.abs().sqrt())
    }
}

impl Rig {
    /// How each camera sees the middle of the volume.
    ///
    /// # Errors
    /// A camera that does not see it, or in which a hand would be so small that fingers are narrower
    /// than a pixel, or so large that not one fits: units are mistaken, or the volume is elsewhere.
    pub fn view_scales(&self) -> Result<Vec<ViewScale>> {
        let scale = |camera: &Camera| {
            let name = || camera.name.clone();
            let px_per_mm = camera
                .px_per_mm(self.volume.center)
                .ok_or_else(|| Error::VolumeOutside { camera: name() })?;
            let distance = camera.centre().distance(self.volume.center);
            let scale = ViewScale { camera: name(), distance, px_per_mm };
            let side = f64::from(camera.intrinsics.width.max(camera.intrinsics.height));
            let is_seen = px_per_mm * ViewScale::FINGER_MM >= 1.0
                && scale.hand_px() <= ViewScale::MOST_PICTURES * side;
            if is_seen {
                Ok(scale)
            } else {
                Err(Error::HandSize { camera: name(), px: scale.hand_px(), distance })
            }
        };
        self.cameras.iter().map(scale).collect()
    }

    /// At which angle each two cameras see the middle of the volume.
    pub fn view_angles(&self) -> Vec<ViewAngle> {
        let towards = |camera: &Camera| self.volume.center - camera.centre();
        let mut angles = Vec::new();
        for (index, first) in self.cameras.iter().enumerate() {
            for second in &self.cameras[index + 1..] {
                angles.push(ViewAngle {
                    first: first.name.clone(),
                    second: second.name.clone(),
                    angle: towards(first).angle_between(towards(second)),
                });
            }
        }
        angles
    }
}
