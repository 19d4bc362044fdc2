//! Outlines: what a solid looks like through a pinhole.
//!
//! A sphere, squashed or not, projects to an ellipse, and a hull of spheres to the hull of their
//! ellipses (Hartley and Zisserman, 2004, *Multiple View Geometry*, § 8.3: a quadric's outline
//! is the conic whose dual is P Q* Pᵀ).

use std::f64::consts::{PI, TAU};

use glam::{DMat2, DMat3, DVec2, DVec3};
use phalanx_hand::{Primitive, Sphere};

/// A filled ellipse of the normalised image plane: middle + √shape · (unit disc).
#[derive(Clone, Copy, Default)]
struct Ellipse {
    middle: DVec2,
    shape: DMat2,
}

impl Ellipse {
    /// The outline of a sphere, in the camera's frame, squashed by `squash` about `anchor`; `None`
    /// where the squashed sphere comes to depth `near`.
    fn of(sphere: &Sphere, squash: DMat3, anchor: DVec3, near: f64) -> Option<Self> {
        let c = anchor + squash * (sphere.center - anchor);
        let m = squash * squash.transpose() * (sphere.radius * sphere.radius);
        let depth_radius = m.z_axis.z.sqrt();
        let nearest = c.z - depth_radius;
        if nearest <= near || nearest.is_nan() {
            return None;
        }
        // The dual conic c cᵀ − m over its corner k, expanded so that nothing cancels.
        let k = nearest * (c.z + depth_radius);
        let (u, b) = (c.truncate(), m.z_axis.truncate());
        let outer = |v: DVec2, w: DVec2| DMat2::from_cols(v * w.x, v * w.y);
        let middle = (u * c.z - b) / k;
        let corner = DMat2::from_cols(m.x_axis.truncate(), m.y_axis.truncate());
        let shape = corner / k
            + (outer(u, u) * m.z_axis.z - (outer(u, b) + outer(b, u)) * c.z + outer(b, b))
                / (k * k);
        Some(Self { middle, shape })
    }

    /// The largest radius of curvature: a²/b of the half-axes.
    fn flattest(&self) -> f64 {
        let half_trace = 0.5 * (self.shape.x_axis.x + self.shape.y_axis.y);
        let determinant = self.shape.determinant();
        let squared = half_trace + (half_trace * half_trace - determinant).max(0.0).sqrt();
        squared * (squared / determinant).sqrt()
    }

    /// The furthest point towards `normal`, of any length, and its dot product with `normal`.
    fn support(&self, normal: DVec2) -> (f64, DVec2) {
        let across = self.shape * normal;
        let half_width = normal.dot(across).sqrt();
        (normal.dot(self.middle) + half_width, self.middle + across / half_width)
    }
}

/// Appends the corners of a solid's outline, in order, in the normalised image plane, so many that
/// the polygon stays within `deviation` inside the outline. `None` where the solid comes to depth
/// `near`, mm, of at least 0.
pub(crate) fn trace(
    solid_in_camera: &Primitive,
    near: f64,
    deviation: f64,
    corners: &mut Vec<DVec2>,
) -> Option<()> {
    let spheres = solid_in_camera.spheres();
    let squash = solid_in_camera.squash();
    let mut ellipses = [Ellipse::default(); 3];
    for (ellipse, sphere) in ellipses.iter_mut().zip(spheres) {
        *ellipse = Ellipse::of(sphere, squash, spheres[0].center, near)?;
    }
    walk(&ellipses[..spheres.len()], deviation, corners);
    Some(())
}

/// Walks once around the hull of some ellipses by the direction of its normal: the furthest
/// ellipse in each direction gives the corner.
fn walk(ellipses: &[Ellipse], deviation: f64, corners: &mut Vec<DVec2>) {
    // While its normal turns by 2π/n, a curve of radius ρ strays π²ρ/2n² from its chord.
    let radius = ellipses.iter().map(Ellipse::flattest).fold(0.0, f64::max);
    let steps = (PI * (radius / (2.0 * deviation)).sqrt()).ceil().clamp(12.0, 1024.0) as u32;
    let turn = DVec2::from_angle(TAU / f64::from(steps));
    let mut normal = DVec2::X;
    let (mut leader, mut corner) = furthest(ellipses, normal);
    for _ in 0..steps {
        corners.push(corner);
        let next_normal = turn.rotate(normal);
        let (next_leader, next_corner) = furthest(ellipses, next_normal);
        if next_leader != leader {
            change(ellipses, [leader, next_leader], [normal, next_normal], corners);
        }
        (normal, leader, corner) = (next_normal, next_leader, next_corner);
    }
}

/// The ellipse that reaches furthest towards `normal`, and its furthest point.
fn furthest(ellipses: &[Ellipse], normal: DVec2) -> (usize, DVec2) {
    let mut best = (0, ellipses[0].support(normal));
    for (index, ellipse) in ellipses.iter().enumerate().skip(1) {
        let support = ellipse.support(normal);
        if support.0 > best.1.0 {
            best = (index, support);
        }
    }
    (best.0, best.1.1)
}

/// Appends the corners where the lead changes between two normals from one ellipse to another.
fn change(
    ellipses: &[Ellipse],
    [from, to]: [usize; 2],
    [first, last]: [DVec2; 2],
    corners: &mut Vec<DVec2>,
) {
    let (normal, touches) = tangent([&ellipses[from], &ellipses[to]], [first, last]);
    let (between, _) = furthest(ellipses, normal);
    if between == from || between == to {
        corners.extend(touches);
    } else {
        // A third leads for less than a step. Far from the others it still matters.
        let lines = [([from, between], [first, normal]), ([between, to], [normal, last])];
        for (pair, normals) in lines {
            corners.extend(tangent(pair.map(|i| &ellipses[i]), normals).1);
        }
    }
}

/// The normal of the common tangent of two ellipses, and where it touches them, when the first
/// leads at one normal and the second at the next.
fn tangent([one, other]: [&Ellipse; 2], [mut first, mut last]: [DVec2; 2]) -> (DVec2, [DVec2; 2]) {
    let lead = |normal: DVec2| one.support(normal).0 - other.support(normal).0;
    let mut normal = first;
    // Two steps of false position: the lead is nearly linear over so small a turn.
    for _ in 0..2 {
        let (before, after) = (lead(first), lead(last));
        let share = if before > after { before / (before - after) } else { 0.5 };
        normal = first.lerp(last, share.clamp(0.0, 1.0));
        if lead(normal) > 0.0 {
            first = normal;
        } else {
            last = normal;
        }
    }
    (normal, [one.support(normal).1, other.support(normal).1])
}
