//! Where a camera stands.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// Where a camera stands: x_cam = R x_world + t, with x to the right of the image, y down it
/// and z along the view.
///
/// ```
/// use glam::{DMat3, DVec3};
/// use phalanx_camera::Extrinsics;
///
/// let half_a_metre_back =
///     Extrinsics { rotation: DMat3::IDENTITY, translation: DVec3::new(0.0, 0.0, 500.0) };
/// assert_eq!(half_a_metre_back.centre(), DVec3::new(0.0, 0.0, -500.0));
/// let point = DVec3::new(1.0, 2.0, 3.0);
/// assert_eq!(half_a_metre_back.to_world(half_a_metre_back.to_camera(point)), point);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Extrinsics {
    /// R, from world to camera.
    pub rotation: DMat3,
    /// t, mm.
    pub translation: DVec3,
}

impl Extrinsics {
    /// How far from orthonormal a rotation may be (the largest element of |RᵀR − I|): matrices
    /// written to six decimals pass.
    pub const ORTHONORMAL_TOLERANCE: f64 = 1e-5;

    /// A world point in the camera's frame, mm.
    pub fn to_camera(&self, world: DVec3) -> DVec3 {
        self.rotation * world + self.translation
    }

    /// A point of the camera's frame in the world, mm.
    pub fn to_world(&self, camera: DVec3) -> DVec3 {
        self.rotation.transpose() * (camera - self.translation)
    }

    /// The camera's centre of projection in the world, mm.
    pub fn centre(&self) -> DVec3 {
        self.to_world(DVec3::ZERO)
    }

    /// Stands at `position`, looks at `target`, with `up` upwards in the image (mm, world).
    pub(crate) fn look_at(camera: &str, position: DVec3, target: DVec3, up: DVec3) -> Result<Self> {
        let camera = || camera.to_owned();
        for (field, v) in [("position_mm", position), ("look_at_mm", target), ("up", up)] {
            if !v.is_finite() {
                return Err(Error::NotFinite { camera: camera(), field });
            }
        }
        let z = (target - position)
            .try_normalize()
            .ok_or_else(|| Error::LookAtIsPosition { camera: camera() })?;
        let across = z.cross(up.normalize_or_zero());
        if across.length() < 1e-6 {
            return Err(Error::UpAlongView { camera: camera() });
        }
        let x = across.normalize();
        let rotation = DMat3::from_cols(x, z.cross(x), z).transpose();
        Ok(Self { rotation, translation: -(rotation * position) })
    }

    /// Checks both fields on behalf of the camera of this name.
    pub(crate) fn validate(&self, camera: &str) -> Result<()> {
        let camera = || camera.to_owned();
        if !self.rotation.is_finite() {
            return Err(Error::NotFinite { camera: camera(), field: "rotation" });
        }
        if !self.translation.is_finite() {
            return Err(Error::NotFinite { camera: camera(), field: "translation_mm" });
        }
        let gram = self.rotation.transpose() * self.rotation - DMat3::IDENTITY;
        let deviation = gram.to_cols_array().iter().fold(0.0, |most: f64, e| most.max(e.abs()));
        if deviation > Self::ORTHONORMAL_TOLERANCE {
            return Err(Error::NotOrthonormal { camera: camera(), deviation });
        }
        if self.rotation.determinant() < 0.0 {
            return Err(Error::Reflection { camera: camera() });
        }
        Ok(())
    }
}
