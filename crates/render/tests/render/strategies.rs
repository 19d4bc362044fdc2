//! Random cameras and solids for the tests.

use glam::{DVec2, DVec3};
use phalanx_camera::{Camera, Distortion, Fisheye, Intrinsics, Lens};
use phalanx_hand::{Primitive, Sphere};
use proptest::prelude::*;

/// A camera 300 mm in front of the origin that looks at it along the world's z axis.
pub(crate) fn camera(intrinsics: Intrinsics) -> Camera {
    let position = DVec3::new(0.0, 0.0, -300.0);
    Camera::look_at("front", intrinsics, position, DVec3::ZERO, DVec3::NEG_Y).expect("valid")
}

/// A lens that keeps to itself within a 120×90 image of focal length 110 px.
pub(crate) fn lenses() -> impl Strategy<Value = Lens> {
    let bent = (-0.2..0.3f64, -0.05..0.05f64, -0.01..0.01f64, -0.01..0.01f64)
        .prop_map(|(k1, k2, p1, p2)| Distortion { k1, k2, p1, p2, ..Distortion::NONE }.into());
    let fisheye = (-0.1..0.1f64, -0.05..0.05f64)
        .prop_map(|(k1, k2)| Fisheye { k1, k2, ..Fisheye::default() }.into());
    prop_oneof![Just(Lens::PERFECT), bent, fisheye]
}

pub(crate) fn spheres(reach: f64) -> impl Strategy<Value = Sphere> {
    (-reach..reach, -reach..reach, -60.0..60.0, 3.0..30.0)
        .prop_map(|(x, y, z, radius)| Sphere::new(DVec3::new(x, y, z), radius))
}

/// Spheres before, behind and beside the camera, and around it.
fn spheres_all_around() -> impl Strategy<Value = Sphere> {
    (-150.0..150.0, -150.0..150.0, -500.0..-100.0, 3.0..50.0)
        .prop_map(|(x, y, z, radius)| Sphere::new(DVec3::new(x, y, z), radius))
}

pub(crate) fn unit_vectors() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0f64, 0.0..6.3f64).prop_map(|(height, turn)| {
        (DVec2::from_angle(turn) * (1.0 - height * height).sqrt()).extend(height)
    })
}

pub(crate) fn cylinders(reach: f64) -> impl Strategy<Value = Primitive> {
    squashed(spheres(reach), spheres(reach))
}

fn squashed(
    a: impl Strategy<Value = Sphere>,
    b: impl Strategy<Value = Sphere>,
) -> impl Strategy<Value = Primitive> {
    (a, b, unit_vectors(), 0.3..1.0f64).prop_map(|(a, b, thin_axis, flatness)| {
        Primitive::GeneralisedCylinder { ends: [a, b], thin_axis, flatness }
    })
}

/// Any solid with its spheres within `reach` mm of the view's axis.
pub(crate) fn solids(reach: f64) -> impl Strategy<Value = Primitive> {
    solids_of(move || spheres(reach))
}

/// Any solid, most of which cross the camera's plane.
pub(crate) fn crossing_solids() -> impl Strategy<Value = Primitive> {
    solids_of(spheres_all_around)
}

fn solids_of<S: Strategy<Value = Sphere>>(
    sphere: impl Fn() -> S,
) -> impl Strategy<Value = Primitive> {
    prop_oneof![
        sphere().prop_map(Primitive::Sphere),
        (sphere(), sphere()).prop_map(|(a, b)| Primitive::RoundCone([a, b])),
        (sphere(), sphere(), sphere()).prop_map(|(a, b, c)| Primitive::Wedge([a, b, c])),
        squashed(sphere(), sphere()),
    ]
}
