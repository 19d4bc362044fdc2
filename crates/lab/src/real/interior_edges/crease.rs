//! Where a drawn hand hides part of itself.

use anyhow::Result;
use glam::{DVec2, DVec3};
use phalanx_camera::Camera;
use phalanx_hand::{PosedHand, Primitive, Sphere};
use phalanx_render::Renderer;

/// How much further away what is behind must be, mm: less than a finger's thickness, more than the steps
/// between the solids of one finger.
const GAP_MM: f64 = 5.0;

/// Half the side of the window that says which way the crease faces, px.
const WINDOW: i32 = 3;

/// A pixel of a drawn hand beside pixels of it that are further away.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crease {
    /// Where the nearer solid ends, px.
    pub(super) at: DVec2,
    /// The unit vector of the picture that points to what is further away.
    pub(super) normal: DVec2,
    /// The place on the nearer solid, in the world, mm.
    pub(super) point: DVec3,
    /// The nearer solid, by its number.
    pub(super) primitive: usize,
}

/// The depths of a drawn hand.
struct Depths {
    width: i32,
    height: i32,
    z: Vec<f32>,
}

impl Depths {
    fn of(camera: &Camera, primitives: &[Primitive]) -> Result<Self> {
        let map = Renderer::new(camera)?.depth(primitives)?;
        Ok(Self { width: map.width as i32, height: map.height as i32, z: map.depths })
    }

    /// The depth at a pixel, mm; infinite beside the hand.
    fn at(&self, x: i32, y: i32) -> f64 {
        let is_inside = (0..self.width).contains(&x) && (0..self.height).contains(&y);
        if !is_inside {
            return f64::INFINITY;
        }
        f64::from(self.z[(y * self.width + x) as usize])
    }
}

/// The creases of a hand in a camera's picture that are further than `inside` px from the silhouette's
/// border.
///
/// # Errors
/// A hand that the camera cannot draw.
pub(super) fn creases(camera: &Camera, hand: &PosedHand, inside: f64) -> Result<Vec<Crease>> {
    let all = Depths::of(camera, &hand.primitives)?;
    let mut creases = Vec::new();
    for y in 0..all.height {
        for x in 0..all.width {
            let z = all.at(x, y);
            let is_behind = |(dx, dy): (i32, i32)| all.at(x + dx, y + dy) > z + GAP_MM;
            if !z.is_finite() || ![(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().any(is_behind) {
                continue;
            }
            let Some(normal) = facing(&all, [x, y], z) else { continue };
            let middle = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            let is_hand = |along: f64| {
                let place = middle + normal * along;
                all.at(place.x as i32, place.y as i32).is_finite()
            };
            if !is_hand(inside) || !is_hand(-inside) {
                continue;
            }
            let Some(ray) = camera.unproject(middle) else { continue };
            let along = (camera.extrinsics.rotation * ray.direction).z;
            let point = ray.origin + ray.direction * (z / along);
            let off = |k: &usize| off_surface(&hand.primitives[*k], point);
            let nearest = |a: &usize, b: &usize| off(a).total_cmp(&off(b));
            let Some(primitive) = (0..hand.primitives.len()).min_by(nearest) else { continue };
            creases.push(Crease { at: middle + 0.5 * normal, normal, point, primitive });
        }
    }
    Ok(creases)
}

/// Which way what is further away lies from a pixel; none where the silhouette ends nearby.
fn facing(all: &Depths, [x, y]: [i32; 2], z: f64) -> Option<DVec2> {
    let mut sum = DVec2::ZERO;
    for dy in -WINDOW..=WINDOW {
        for dx in -WINDOW..=WINDOW {
            let other = all.at(x + dx, y + dy);
            if other.is_infinite() {
                return None;
            }
            if other > z + GAP_MM {
                sum += DVec2::new(f64::from(dx), f64::from(dy));
            }
        }
    }
    sum.try_normalize()
}

/// How far a point is from the surface of a solid's round edges, mm.
fn off_surface(solid: &Primitive, point: DVec3) -> f64 {
    let spheres = solid.spheres();
    let between = |a: &Sphere, b: &Sphere| {
        let axis = b.center - a.center;
        let along = (point - a.center).dot(axis) / axis.length_squared().max(f64::MIN_POSITIVE);
        let along = along.clamp(0.0, 1.0);
        let radius = a.radius + along * (b.radius - a.radius);
        (point.distance(a.center + along * axis) - radius).abs()
    };
    let edges = spheres
        .iter()
        .enumerate()
        .flat_map(|(k, a)| spheres[k..].iter().map(move |b| between(a, b)));
    edges.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;
    use phalanx_camera::Intrinsics;
    use phalanx_hand::{HandShape, Pose};

    use super::*;

    /// A small ball before a large one.
    #[test]
    fn a_crease_faces_what_is_behind_it() {
        let intrinsics = Intrinsics::pinhole(120, 90, 265.0);
        let camera = Camera::look_at("top", intrinsics, 700.0 * DVec3::Y, DVec3::ZERO, DVec3::X);
        let camera = camera.unwrap();
        let mut hand = HandShape::adult().pose(&Pose::REST, &DAffine3::IDENTITY);
        hand.primitives = [(DVec3::ZERO, 60.0), (90.0 * DVec3::Y, 20.0)]
            .map(|(centre, radius)| Primitive::Sphere(Sphere::new(centre, radius)))
            .to_vec();
        let found = creases(&camera, &hand, 3.0).unwrap();
        assert!(found.len() > 20, "{}", found.len());
        let middle = DVec2::new(60.0, 45.0);
        for crease in found {
            assert_eq!(crease.primitive, 1);
            assert!((crease.point.distance(90.0 * DVec3::Y) - 20.0).abs() < 1.0);
            assert!(crease.normal.dot((crease.at - middle).normalize()) > 0.9);
        }
    }
}
