//! Closed-form hits against the distance to a hull, found by search.

use glam::{DMat3, DVec2, DVec3};
use phalanx_hand::{Primitive, Sphere};
use proptest::prelude::*;

use crate::solid::Scene;

/// The least value of a convex function on 0..1.
fn least(mut f: impl FnMut(f64) -> f64) -> f64 {
    let (mut from, mut to) = (0.0, 1.0);
    for _ in 0..48 {
        let third = (to - from) / 3.0;
        if f(from + third) < f(to - third) {
            to -= third;
        } else {
            from += third;
        }
    }
    f(0.5 * (from + to))
}

/// Signed distance from a point to the hull of spheres: the least over all spheres between them.
fn distance(spheres: &[Sphere], point: DVec3) -> f64 {
    let to = |center: DVec3, radius: f64| (point - center).length() - radius;
    match spheres {
        [a] => to(a.center, a.radius),
        [a, b] => least(|x| to(a.center.lerp(b.center, x), a.radius + (b.radius - a.radius) * x)),
        [a, b, c] => least(|x| {
            let radius = a.radius + (b.radius - a.radius) * x;
            let between = Sphere::new(a.center.lerp(b.center, x), radius);
            distance(&[between, *c], point)
        }),
        _ => unreachable!("solids have one to three spheres"),
    }
}

/// The distance before squashing: the right sign, and zero at the right places.
fn unsquashed(solid: &Primitive, point: DVec3) -> f64 {
    let (spheres, unsquash) = (solid.spheres(), solid.squash().inverse());
    distance(spheres, spheres[0].center + unsquash * (point - spheres[0].center))
}

fn gradient(f: impl Fn(DVec3) -> f64, at: DVec3) -> DVec3 {
    let step = 1e-4;
    DMat3::IDENTITY.to_cols_array_2d().iter().fold(DVec3::ZERO, |sum, axis| {
        let axis = DVec3::from_array(*axis);
        sum + axis * (f(at + axis * step) - f(at - axis * step)) / (2.0 * step)
    })
}

prop_compose! {
    fn spheres()(x in -40.0..40.0, y in -40.0..40.0, z in 260.0..340.0, radius in 2.0..25.0) -> Sphere {
        Sphere::new(DVec3::new(x, y, z), radius)
    }
}

fn solids() -> impl Strategy<Value = Primitive> {
    let squashed = (spheres(), spheres(), -1.0..1.0f64, 0.0..6.0f64, 0.3..1.0f64);
    prop_oneof![
        spheres().prop_map(Primitive::Sphere),
        (spheres(), spheres()).prop_map(|(a, b)| Primitive::RoundCone([a, b])),
        (spheres(), spheres(), spheres()).prop_map(|(a, b, c)| Primitive::Wedge([a, b, c])),
        squashed.prop_map(|(a, b, height, turn, flatness)| {
            let across = DVec2::from_angle(turn) * (1.0 - height * height).sqrt();
            let thin_axis = across.extend(height);
            Primitive::GeneralisedCylinder { ends: [a, b], thin_axis, flatness }
        }),
    ]
}

proptest! {
    #![proptest_config(crate::property::cases(300))]

    #[test]
    fn rays_stop_where_the_distance_falls_to_zero(
        solid in solids(), x in -0.2..0.2, y in -0.2..0.2,
    ) {
        let everywhere = [DVec2::splat(-1e3), DVec2::splat(1e3)];
        let mut scene = Scene::default();
        scene.push(&solid, &everywhere);
        let direction = DVec3::new(x, y, 1.0);
        let hit = scene.nearest(DVec2::ZERO, direction);
        let free = hit.map_or(450.0, |hit| hit.distance);
        for step in 0..60 {
            let at = 150.0 + (free - 150.0) * f64::from(step) / 60.0;
            prop_assert!(unsquashed(&solid, direction * at) > -1e-6, "inside already at {at}");
        }
        if let Some(hit) = hit {
            let point = direction * hit.distance;
            prop_assert!(unsquashed(&solid, point).abs() < 1e-6);
            let outward = gradient(|p| unsquashed(&solid, p), point).normalize();
            let turned = hit.normal.normalize().cross(outward).length();
            // A grazing ray's hit is ill-conditioned, and so is a normal at a seam.
            prop_assert!(turned < 1e-3 && hit.normal.dot(outward) > 0.0, "turned by {turned}");
        }
    }
}
