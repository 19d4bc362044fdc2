//! Solids that reach or cross the camera's plane, against a search along the rays.

use crate::property;
use crate::silhouette::{assert_like_rays, lens, silhouette};
use crate::strategies::{crossing_solids, lenses, solids};
use glam::{DAffine3, DVec2, DVec3};
use phalanx_camera::{Camera, Distortion};
use phalanx_hand::{Primitive, Sphere};
use phalanx_render::{Appearance, Background, Renderer, Supersampling};
use proptest::prelude::*;

/// The least value of a convex function on 0..1.
fn least(f: &dyn Fn(f64) -> f64) -> f64 {
    let (mut from, mut to) = (0.0, 1.0);
    for _ in 0..40 {
        let third = (to - from) / 3.0;
        if f(from + third) < f(to - third) {
            to -= third;
        } else {
            from += third;
        }
    }
    f(0.5 * (from + to))
}

/// How far a ray from an origin passes outside the hull of some spheres: the least over all spheres
/// between them.
fn passes(spheres: &[Sphere], origin: DVec3, direction: DVec3) -> f64 {
    let outside = |sphere: &Sphere| {
        let to = sphere.center - origin;
        to.distance(direction * direction.dot(to).max(0.0)) - sphere.radius
    };
    let between = |a: &Sphere, b: &Sphere, x: f64| {
        Sphere::new(a.center.lerp(b.center, x), a.radius + (b.radius - a.radius) * x)
    };
    match spheres {
        [a] => outside(a),
        [a, b] => least(&|x| outside(&between(a, b, x))),
        [a, b, c] => least(&|x| passes(&[between(a, b, x), *c], origin, direction)),
        _ => unreachable!("solids have one to three spheres"),
    }
}

/// Whether a pixel position sees a solid, by search.
fn sees(camera: &Camera, solid: &Primitive, pixel: DVec2) -> bool {
    let to_camera =
        DAffine3::from_mat3_translation(camera.extrinsics.rotation, camera.extrinsics.translation);
    let solid = solid.moved(&to_camera);
    let (spheres, unsquash) = (solid.spheres(), solid.squash().inverse());
    let origin = spheres[0].center - unsquash * spheres[0].center;
    let Some(direction) = camera.intrinsics.to_normalised(pixel) else { return false };
    passes(spheres, origin, (unsquash * direction.extend(1.0)).normalize()) < 0.0
}

proptest! {
    #![proptest_config(property::cases(200))]

    #[test]
    fn what_crosses_the_camera_s_plane_is_clipped(
        solid in crossing_solids(), distortion in lenses(),
    ) {
        let camera = lens(distortion);
        let mask = silhouette(&camera, &[solid]);
        for (x, y) in (0..90).step_by(7).flat_map(|y| (0..120).step_by(7).map(move |x| (x, y))) {
            let pixel = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            let covered = mask.get_pixel(x, y).0[0] > 127;
            // Outlines are right to 0.01 px.
            let around = [DVec2::ZERO, DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y];
            let alike = around.iter().any(|by| covered == sees(&camera, &solid, pixel + by * 0.02));
            prop_assert!(alike, "{x}, {y} is {covered}");
        }
    }

    #[test]
    fn clipped_silhouettes_are_what_rays_meet(
        solids in prop::collection::vec(prop_oneof![crossing_solids(), solids(90.0)], 1..4),
        distortion in lenses(),
    ) {
        assert_like_rays(&lens(distortion), &solids);
    }

    /// A solid that touches the depth from which on it is clipped looks the same on both sides of it.
    #[test]
    fn clipping_sets_in_smoothly(x in -60.0..60.0, y in -60.0..60.0, radius in 3.0..30.0) {
        let near = |gap: f64| {
            let center = DVec3::new(x, y, -300.0 + radius + 1.0 + gap);
            let cone = [Sphere::new(center, radius), Sphere::new(DVec3::ZERO, 20.0)];
            let mut renderer = Renderer::new(&lens(Distortion::NONE)).unwrap();
            renderer.coverage(&[Primitive::RoundCone(cone)], Supersampling::X8).unwrap()
        };
        let (before, clipped) = (near(1e-9), near(-1e-9));
        // A sample of a pixel's 64 may lie between the two polygons.
        let alike = before.iter().zip(clipped.iter()).all(|(a, b)| a.abs_diff(*b) <= 32);
        prop_assert!(alike);
    }
}

#[test]
fn what_is_behind_the_camera_is_not_seen() {
    let behind = Primitive::Sphere(Sphere::new(DVec3::new(0.0, 0.0, -400.0), 30.0));
    let camera = lens(Distortion::NONE);
    assert!(silhouette(&camera, &[behind]).iter().all(|&grey| grey == 0));
    let depth = Renderer::new(&camera).unwrap().depth(&[behind]).unwrap();
    assert!(depth.depths.iter().all(|z| z.is_infinite()));
}

#[test]
fn what_holds_the_camera_covers_everything() {
    let around = Primitive::Sphere(Sphere::new(DVec3::new(0.0, 0.0, -310.0), 30.0));
    let camera = lens(Distortion { k1: -0.2, ..Distortion::NONE });
    assert!(silhouette(&camera, &[around]).iter().all(|&grey| grey == 255));
    let mut renderer = Renderer::new(&camera).unwrap();
    assert!(renderer.depth(&[around]).unwrap().depths.iter().all(|z| *z == 1.0));
    let look = Appearance {
        background: Background::Plain([0, 0, 255]),
        noise_sigma: 0.0,
        ..Appearance::default()
    };
    let shaded = renderer.shade(&[around], &look, 1).unwrap();
    assert!(shaded.pixels().all(|pixel| pixel.0[0] > pixel.0[2]));
}
