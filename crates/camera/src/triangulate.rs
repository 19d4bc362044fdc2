//! The point that several rays agree on.

use glam::{DMat3, DVec3};

use crate::camera::Ray;
use crate::error::{Error, Result};

/// The point nearest to several rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangulation {
    /// The point, mm.
    pub point: DVec3,
    /// Root mean square of its distances from the rays' lines, mm: 0 where they all meet.
    pub spread: f64,
}

/// The sine of the least angle at which two rays have a nearest point.
const LEAST_SINE: f64 = 1e-3;

/// The point with the least sum of squared distances from the rays' lines.
///
/// # Errors
/// Fewer than two rays, or rays that are all but parallel, or not finite.
///
/// ```
/// use glam::DVec3;
/// use phalanx_camera::{Ray, triangulate};
///
/// let along_x = Ray { origin: DVec3::new(-9.0, 0.0, 0.0), direction: DVec3::X };
/// let along_y = Ray { origin: DVec3::new(3.0, -9.0, 2.0), direction: DVec3::Y }; // 2 mm above it
/// let meeting = triangulate(&[along_x, along_y])?;
/// assert!((meeting.point - DVec3::new(3.0, 0.0, 1.0)).length() < 1e-9);
/// assert!((meeting.spread - 1.0).abs() < 1e-9);
/// # Ok::<(), phalanx_camera::Error>(())
/// ```
pub fn triangulate(rays: &[Ray]) -> Result<Triangulation> {
    if rays.len() < 2 {
        return Err(Error::TooFewRays { found: rays.len() });
    }
    // I − d dᵀ takes a vector's part across the ray.
    let across = |ray: &Ray| {
        let d = ray.direction;
        DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z)
    };
    // About the first origin, so that a far-off world origin costs no digits.
    let middle = rays[0].origin;
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for ray in rays {
        normal += across(ray);
        right += across(ray) * (ray.origin - middle);
    }
    // Of two rays at an angle a the determinant is 2 sin² a; each further ray adds to it.
    let determinant = normal.determinant();
    if determinant.is_nan() || determinant < 2.0 * LEAST_SINE * LEAST_SINE {
        return Err(Error::ParallelRays);
    }
    let point = middle + normal.inverse() * right;
    let squared = |ray: &Ray| (across(ray) * (point - ray.origin)).length_squared();
    let spread = (rays.iter().map(squared).sum::<f64>() / rays.len() as f64).sqrt();
    if point.is_finite() && spread.is_finite() {
        Ok(Triangulation { point, spread })
    } else {
        Err(Error::ParallelRays)
    }
}
