//! A calibrated camera.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::extrinsics::Extrinsics;
use crate::intrinsics::Intrinsics;

/// A half-line in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts, mm.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
}

/// A calibrated camera with a name.
///
/// ```
/// use glam::{DVec2, DVec3};
/// use phalanx_camera::{Camera, Intrinsics};
///
/// let above = DVec3::new(0.0, 700.0, 0.0);
/// let camera =
///     Camera::look_at("top", Intrinsics::pinhole(120, 90, 265.0), above, DVec3::ZERO, DVec3::X)?;
/// assert_eq!(camera.project(DVec3::ZERO), Some(DVec2::new(60.0, 45.0)));
/// assert_eq!(camera.project(2.0 * above), None); // behind it
/// let ray = camera.unproject(DVec2::new(60.0, 45.0)).expect("a perfect lens maps all");
/// assert_eq!((ray.origin, ray.direction), (above, -DVec3::Y));
/// # Ok::<(), phalanx_camera::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// The name; also that of its folder of pictures.
    pub name: String,
    /// From directions to pixels.
    pub intrinsics: Intrinsics,
    /// From the world to the camera's frame.
    pub extrinsics: Extrinsics,
}

impl Camera {
    /// A camera at `position` that looks at `target` (mm), with the world direction `up`
    /// upwards in its image.
    pub fn look_at(
        name: impl Into<String>,
        intrinsics: Intrinsics,
        position: DVec3,
        target: DVec3,
        up: DVec3,
    ) -> Result<Self> {
        let name = name.into();
        let extrinsics = Extrinsics::look_at(&name, position, target, up)?;
        Ok(Self { name, intrinsics, extrinsics })
    }

    /// The pixel of a world point (mm); `None` behind the camera or beyond the lens's fold.
    /// It may lie outside the image.
    pub fn project(&self, world: DVec3) -> Option<DVec2> {
        let p = self.extrinsics.to_camera(world);
        if p.z > 0.0 { self.intrinsics.to_pixel(p.truncate() / p.z) } else { None }
    }

    /// The ray that a pixel looks along, from the camera's centre; `None` where the lens maps
    /// no direction to the pixel.
    pub fn unproject(&self, pixel: DVec2) -> Option<Ray> {
        let direction = self.intrinsics.to_normalised(pixel)?.extend(1.0);
        Some(Ray {
            origin: self.centre(),
            direction: (self.extrinsics.rotation.transpose() * direction).normalize(),
        })
    }

    /// The centre of projection in the world, mm.
    pub fn centre(&self) -> DVec3 {
        self.extrinsics.centre()
    }

    /// The same camera with other intrinsics, such as those of a cropped or scaled image.
    #[must_use]
    pub fn with_intrinsics(&self, intrinsics: Intrinsics) -> Self {
        Self { name: self.name.clone(), intrinsics, extrinsics: self.extrinsics }
    }

    /// Checks the name and every number.
    pub fn validate(&self) -> Result<()> {
        let allowed = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
        if self.name.is_empty() || self.name.starts_with('.') || !self.name.chars().all(allowed) {
            return Err(Error::Name { camera: self.name.clone() });
        }
        self.intrinsics.validate(&self.name)?;
        self.extrinsics.validate(&self.name)
    }
}
