//! Cameras that look elsewhere from the same place.

use glam::{DMat3, DVec2, DVec3};

use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::extrinsics::Extrinsics;
use crate::intrinsics::Intrinsics;

impl Camera {
    /// A virtual camera: this one turned about its centre, so that its axis goes along `ahead`
    /// and its image's x as nearly as can be along `right` (directions in the world, of any
    /// length), with other intrinsics. What it sees follows from this camera's picture alone; see
    /// [`PixelMap`].
    ///
    /// # Errors
    /// A direction that is zero or not finite, or both in one line.
    pub fn turned(&self, ahead: DVec3, right: DVec3, intrinsics: Intrinsics) -> Result<Self> {
        let no_axis = || Error::VirtualAxis { camera: self.name.clone(), ahead, right };
        let z = ahead.try_normalize().ok_or_else(no_axis)?;
        let y = z.cross(right.normalize_or_zero());
        if y.length() < 1e-6 {
            return Err(no_axis());
        }
        let y = y.normalize();
        let rotation = DMat3::from_cols(y.cross(z), y, z).transpose();
        let translation = -(rotation * self.centre());
        let extrinsics = Extrinsics { rotation, translation };
        Ok(Self { name: self.name.clone(), intrinsics, extrinsics })
    }
}

/// From one camera's pixels to those of another at the same place: where both see the same things.
///
/// ```
/// use glam::{DVec2, DVec3};
/// use phalanx_camera::{Camera, Intrinsics, PixelMap};
///
/// let wide = Intrinsics::pinhole(640, 480, 500.0);
/// let camera = Camera::look_at("desk", wide, DVec3::Z, DVec3::ZERO, DVec3::Y)?;
/// // Turned to what is at a corner of the picture, and zoomed onto it.
/// let corner = DVec2::new(600.0, 40.0);
/// let ahead = camera.unproject(corner).expect("a perfect lens").direction;
/// let window = camera.turned(ahead, DVec3::X, Intrinsics::pinhole(120, 90, 1500.0))?;
/// let map = PixelMap::between(&camera, &window);
/// let middle = map.map(corner).expect("in front of both");
/// assert!((middle - DVec2::new(60.0, 45.0)).length() < 1e-9);
/// assert!((map.inverse().map(middle).expect("the way back") - corner).length() < 1e-9);
/// # Ok::<(), phalanx_camera::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelMap {
    from: Intrinsics,
    to: Intrinsics,
    turn: DMat3,
}

impl PixelMap {
    /// The map between two cameras of one centre, such as a camera and one
    /// [turned](Camera::turned) from it; their own centres are not compared.
    pub fn between(from: &Camera, to: &Camera) -> Self {
        let turn = to.extrinsics.rotation * from.extrinsics.rotation.transpose();
        Self { from: from.intrinsics, to: to.intrinsics, turn }
    }

    /// The way back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self { from: self.to, to: self.from, turn: self.turn.transpose() }
    }

    /// The second camera's pixel for one of the first; `None` where it looks behind the second, or
    /// a lens maps nothing there.
    pub fn map(&self, pixel: DVec2) -> Option<DVec2> {
        let ahead = self.turn * self.from.to_normalised(pixel)?.extend(1.0);
        if ahead.z > 0.0 { self.to.to_pixel(ahead.truncate() / ahead.z) } else { None }
    }
}
