//! Where the hand works.

use glam::{DAffine3, DMat3, DVec3};
use serde::{Deserialize, Serialize};

use crate::camera::{Camera, Ray};
use crate::error::{Error, Result};
use crate::triangulate::triangulate;

/// Where the hand works in the world.
///
/// ```
/// use glam::DVec3;
/// use phalanx_camera::{Camera, Intrinsics, Volume};
///
/// let camera = |name, position| {
///     let intrinsics = Intrinsics::pinhole(120, 90, 265.0);
///     Camera::look_at(name, intrinsics, position, DVec3::new(0.0, 90.0, 0.0), DVec3::Y)
/// };
/// let cameras = [
///     camera("left", DVec3::new(-400.0, 90.0, 600.0))?,
///     camera("right", DVec3::new(400.0, 90.0, 600.0))?,
/// ];
/// let volume = Volume::between(&cameras, 150.0)?;
/// assert!((volume.center - DVec3::new(0.0, 90.0, 0.0)).length() < 1e-9);
/// let fingers = volume.rest_frame().transform_vector3(DVec3::Z);
/// assert!((fingers - DVec3::Y).length() < 1e-9, "they point up the first picture");
/// # Ok::<(), phalanx_camera::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Volume {
    /// Where the wrist is at rest, mm.
    pub center: DVec3,
    /// Extent of the box in which the wrist moves, along the X, Y and Z of
    /// [`rest_frame`](Self::rest_frame), mm.
    pub size: DVec3,
    /// Direction from the elbow to the wrist at rest; of any length.
    pub forearm: DVec3,
    /// Direction out of the back of the hand at rest (palm down); of any length.
    pub up: DVec3,
}

impl Volume {
    /// The hand frame at rest, to the world: origin at the middle, Z along the forearm, Y up
    /// (made orthogonal to Z) and X = Y × Z. Of a volume that [`validate`](Self::validate)
    /// passes; any other still gets some finite frame.
    pub fn rest_frame(&self) -> DAffine3 {
        let z = self.forearm.normalize_or(DVec3::Z);
        let x = self.up.normalize_or(DVec3::Y).cross(z);
        let x = x.normalize_or(z.any_orthonormal_vector());
        DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), self.center)
    }

    /// A guess where cameras that look at one place expect the hand: in a cube of `side` mm about
    /// the point nearest to their axes, its back towards them, the fingers pointing up the first
    /// camera's picture.
    ///
    /// # Errors
    /// A single camera, or axes that are parallel: they meet nowhere.
    pub fn between(cameras: &[Camera], side: f64) -> Result<Self> {
        let axis = |camera: &Camera| camera.extrinsics.rotation.row(2);
        let axes: Vec<Ray> = cameras
            .iter()
            .map(|camera| Ray { origin: camera.centre(), direction: axis(camera) })
            .collect();
        let volume = Self {
            center: triangulate(&axes)?.point,
            size: DVec3::splat(side),
            forearm: -cameras[0].extrinsics.rotation.row(1),
            up: -cameras.iter().map(axis).sum::<DVec3>(),
        };
        volume.validate()?;
        Ok(volume)
    }

    /// Checks that all is finite, the sizes positive, and the directions non-zero and not
    /// parallel.
    pub fn validate(&self) -> Result<()> {
        let unit = |v: DVec3| v.try_normalize().filter(|_| v.is_finite());
        if !self.center.is_finite() {
            return Err(Error::VolumeField { field: "center_mm" });
        }
        if !self.size.is_finite() || self.size.min_element() <= 0.0 {
            return Err(Error::VolumeField { field: "size_mm" });
        }
        let forearm = unit(self.forearm).ok_or(Error::VolumeField { field: "forearm" })?;
        let up = unit(self.up).ok_or(Error::VolumeField { field: "up" })?;
        if up.cross(forearm).length() < 1e-6 {
            return Err(Error::VolumeUpAlongForearm);
        }
        Ok(())
    }
}
