//! Projection and its inverse, moved, cropped, resized and written to TOML.

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3, EulerRot};
use phalanx_camera::{
    Camera, Distortion, Error, Extrinsics, Fisheye, Intrinsics, Lens, PixelMap, Ray, Rig, Volume,
    triangulate,
};
use proptest::prelude::*;

use crate::property;

prop_compose! {
    fn distortions()(
        k1 in -0.3..0.3, k2 in -0.1..0.1, k3 in -0.02..0.02, p1 in -5e-3..5e-3, p2 in -5e-3..5e-3,
    ) -> Distortion {
        Distortion { k1, k2, p1, p2, k3, ..Distortion::NONE }
    }
}

prop_compose! {
    /// With all of OpenCV's coefficients.
    fn rational()(
        plain in distortions(),
        (k4, k5, k6) in (-0.2..0.2, -0.1..0.1, -0.02..0.02),
        (s1, s2, s3, s4) in (-5e-3..5e-3, -5e-3..5e-3, -5e-3..5e-3, -5e-3..5e-3),
        (tau_x, tau_y) in (-0.02..0.02, -0.02..0.02),
    ) -> Distortion {
        Distortion { k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y, ..plain }
    }
}

prop_compose! {
    fn fisheyes()(
        k1 in -0.1..0.1, k2 in -0.05..0.05, k3 in -0.02..0.02, k4 in -0.01..0.01,
    ) -> Fisheye {
        Fisheye { k1, k2, k3, k4 }
    }
}

fn lenses() -> impl Strategy<Value = Lens> {
    prop_oneof![
        Just(Lens::PERFECT),
        distortions().prop_map(Lens::from),
        rational().prop_map(Lens::from),
        fisheyes().prop_map(Lens::from),
    ]
}

prop_compose! {
    fn intrinsics()(
        width in 40u32..800, height in 40u32..600, zoom in 0.8..2.0, aspect in 0.9..1.1,
        (u, v) in (0.4..0.6, 0.4..0.6),
        lens in lenses(),
    ) -> Intrinsics {
        let fx = zoom * f64::from(width.max(height));
        let (cx, cy) = (u * f64::from(width), v * f64::from(height));
        Intrinsics { width, height, fx, fy: fx * aspect, cx, cy, lens }
    }
}

prop_compose! {
    fn rotations()(a in -3.1..3.1, b in -1.5..1.5, c in -3.1..3.1) -> DQuat {
        DQuat::from_euler(EulerRot::XYZ, a, b, c)
    }
}

prop_compose! {
    fn vectors(reach: f64)(x in -reach..reach, y in -reach..reach, z in -reach..reach) -> DVec3 {
        DVec3::new(x, y, z)
    }
}

prop_compose! {
    fn cameras()(intrinsics in intrinsics(), q in rotations(), t in vectors(500.0)) -> Camera {
        let extrinsics = Extrinsics { rotation: DMat3::from_quat(q), translation: t };
        Camera { name: "c".into(), intrinsics, extrinsics }
    }
}

/// Whether the lens maps a direction to every pixel: it may fold over in the corners.
fn reaches_corners(camera: &Camera) -> bool {
    let corners = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)];
    corners.iter().all(|&(u, v)| camera.unproject(pixel_of(camera, u, v)).is_some())
}

/// A pixel anywhere in the picture from two numbers in 0..1.
fn pixel_of(camera: &Camera, u: f64, v: f64) -> DVec2 {
    DVec2::new(f64::from(camera.intrinsics.width) * u, f64::from(camera.intrinsics.height) * v)
}

/// Where a lens puts a radius, but for what is not radial, as its formula is printed.
fn radial(lens: &Lens, r: f64) -> f64 {
    match lens {
        Lens::Perspective(d) => {
            let above = 1.0 + d.k1 * r.powi(2) + d.k2 * r.powi(4) + d.k3 * r.powi(6);
            let below = 1.0 + d.k4 * r.powi(2) + d.k5 * r.powi(4) + d.k6 * r.powi(6);
            // Beyond a pole all has folded over.
            if below > 0.0 { r * above / below } else { f64::NEG_INFINITY }
        }
        Lens::Fisheye(Fisheye { k1, k2, k3, k4 }) => {
            let angle = r.atan();
            let powers = [(k1, 3), (k2, 5), (k3, 7), (k4, 9)];
            angle + powers.iter().map(|&(k, n)| k * angle.powi(n)).sum::<f64>()
        }
    }
}

/// The radial part's smallest slope from the middle of the picture to `radius`, by brute force.
fn least_slope(lens: &Lens, radius: f64) -> f64 {
    let f = |r: f64| radial(lens, r);
    let slopes = (0..20_000).map(|i| f64::from(i) * radius / 20_000.0).map(|r| {
        let step = radius * 1e-6;
        let slope = (f(r + step) - f(r)) / step;
        if slope.is_nan() { f64::NEG_INFINITY } else { slope }
    });
    slopes.fold(f64::INFINITY, f64::min)
}

/// How near the middle of the picture a tilted sensor's horizon comes, in the plane before the tilt: the sensor
/// is seen edge-on in a direction as far off the axis as it is turned from it.
fn nearest_horizon(lens: &Lens) -> f64 {
    match lens {
        Lens::Perspective(d) => (d.tau_x.cos() * d.tau_y.cos()).acos().tan().recip(),
        Lens::Fisheye(_) => f64::INFINITY,
    }
}

proptest! {
    #![proptest_config(property::cases(256))]

    #[test]
    fn unproject_inverts_project(camera in cameras(), u in 0.0..1.0, v in 0.0..1.0,
                                 far in 50.0..2000.0) {
        prop_assume!(camera.validate().is_ok() && reaches_corners(&camera));
        let pixel = pixel_of(&camera, u, v);
        let ray = camera.unproject(pixel).unwrap();
        prop_assert!((ray.direction.length() - 1.0).abs() < 1e-12);
        prop_assert!((ray.origin - camera.centre()).length() == 0.0);
        let seen = camera.project(ray.origin + ray.direction * far).unwrap();
        prop_assert!((seen - pixel).length() < 1e-6, "{pixel} became {seen}");
        prop_assert_eq!(camera.project(ray.origin - ray.direction * far), None);
    }

    #[test]
    fn undistort_inverts_distort(camera in cameras(), u in 0.0..1.0, v in 0.0..1.0) {
        prop_assume!(camera.validate().is_ok() && reaches_corners(&camera));
        let pixel = pixel_of(&camera, u, v);
        let ideal = camera.intrinsics.undistort(pixel).unwrap();
        prop_assert!((camera.intrinsics.distort(ideal).unwrap() - pixel).length() < 1e-8);
        let straight = camera.intrinsics.undistorted().to_normalised(ideal);
        let seen = camera.intrinsics.to_normalised(pixel).unwrap();
        prop_assert!((straight.unwrap() - seen).length() < 1e-12);
    }

    #[test]
    fn the_fold_is_where_the_radius_stops_growing(
        lens in lenses(), x in -3.0..3.0, y in -3.0..3.0,
    ) {
        let point = DVec2::new(x, y);
        let slope = least_slope(&lens, point.length());
        prop_assume!(slope.abs() > 1e-2);
        let is_one_to_one = lens.is_one_to_one_at(point);
        prop_assert!(slope > 0.0 || !is_one_to_one);
        // Far out the horizon of a tilted sensor comes before the fold.
        if slope > 0.0 && radial(&lens, point.length()) < 0.5 * nearest_horizon(&lens) {
            prop_assert!(is_one_to_one);
        }
        let fold = lens.short_of_fold(point);
        prop_assert!(lens.is_one_to_one_at(fold) && is_one_to_one == (fold == point));
        prop_assert!(fold == point || !lens.is_one_to_one_at(fold * (1.0 + 1e-9)));
    }

    #[test]
    fn undistort_finds_whatever_distort_made(d in lenses(), x in -1.5..1.5, y in -1.5..1.5) {
        // Beyond 45 degrees, what is not radial may fold a lens of all coefficients over.
        let has_all = matches!(d, Lens::Perspective(d) if d.s1 != 0.0);
        let point = DVec2::new(x, y) * if has_all { 2.0 / 3.0 } else { 1.0 };
        // Leave out the surroundings of the fold, where the inverse is ill-conditioned.
        prop_assume!(least_slope(&d, point.length()) > 0.2);
        let back = d.undistort(d.distort(point));
        prop_assert!(back.is_some_and(|b| (b - point).length() < 1e-9), "{back:?} is not {point}");
    }

    /// What bends about the middle alone goes along the radius; the slow search for the inverse is by
    /// halving.
    #[test]
    fn radial_lenses_are_inverted_like_their_formula(
        d in rational(), f in fisheyes(), wide in any::<bool>(), r in 0.0..1.2f64, turn in 0.0..6.3f64,
    ) {
        let Distortion { k1, k2, k3, k4, k5, k6, .. } = d;
        let centred = Distortion { k1, k2, k3, k4, k5, k6, ..Distortion::NONE };
        let lens = if wide { Lens::from(f) } else { centred.into() };
        prop_assume!(least_slope(&lens, 1.3) > 0.2);
        let seen = radial(&lens, r);
        let (mut short, mut beyond) = (0.0, 1.3);
        for _ in 0..80 {
            let middle = 0.5 * (short + beyond);
            if radial(&lens, middle) < seen { short = middle } else { beyond = middle }
        }
        let along = DVec2::from_angle(turn);
        prop_assert!((lens.distort(along * r) - along * seen).length() < 1e-12);
        let found = lens.undistort(along * seen).unwrap();
        prop_assert!((found - along * short).length() < 1e-10, "{found} is not {}", along * short);
    }

    #[test]
    fn moving_world_and_camera_together_changes_nothing(
        camera in cameras(), q in rotations(), t in vectors(900.0), point in vectors(900.0),
    ) {
        let motion = DAffine3::from_rotation_translation(q, t);
        let inverse = motion.inverse();
        let moved = Camera {
            extrinsics: Extrinsics {
                rotation: camera.extrinsics.rotation * inverse.matrix3,
                translation: camera.extrinsics.to_camera(inverse.translation),
            },
            ..camera.clone()
        };
        match (camera.project(point), moved.project(motion.transform_point3(point))) {
            (Some(a), Some(b)) => prop_assert!((a - b).length() < 1e-6 * (1.0 + a.length())),
            (a, b) => prop_assert_eq!(a, b),
        }
        let back = camera.extrinsics.to_world(camera.extrinsics.to_camera(point));
        prop_assert!((back - point).length() < 1e-9);
        prop_assert!((motion.transform_point3(camera.centre()) - moved.centre()).length() < 1e-9);
    }

    #[test]
    fn cropping_shifts_pixels_and_resizing_scales_them(
        camera in cameras(), u in 0.0..1.0, v in 0.0..1.0, w in 1u32..900, h in 1u32..900,
    ) {
        prop_assume!(camera.validate().is_ok() && reaches_corners(&camera));
        let pixel = pixel_of(&camera, u, v);
        let point = camera.unproject(pixel).map(|ray| ray.origin + ray.direction * 400.0).unwrap();
        let inside = camera.intrinsics;
        let (x, y) = (inside.width / 4, inside.height / 5);
        let cropped = inside.cropped(x, y, inside.width / 2, inside.height / 2).unwrap();
        let seen = camera.with_intrinsics(cropped).project(point).unwrap();
        let shift = DVec2::new(f64::from(x), f64::from(y));
        prop_assert!((seen + shift - pixel).length() < 1e-6);
        let resized = camera.with_intrinsics(inside.resized(w, h)).project(point).unwrap();
        let scale = DVec2::new(
            f64::from(w) / f64::from(inside.width),
            f64::from(h) / f64::from(inside.height),
        );
        prop_assert!((resized - pixel * scale).length() < 1e-6);
    }

    #[test]
    fn a_virtual_camera_sees_what_the_map_says(
        camera in cameras(), u in 0.0..1.0, v in 0.0..1.0, far in 50.0..2000.0,
        (aim_u, aim_v) in (0.0..1.0, 0.0..1.0), right in vectors(1.0), focal in 80.0..900.0,
    ) {
        prop_assume!(camera.validate().is_ok() && reaches_corners(&camera));
        let aim = camera.unproject(pixel_of(&camera, aim_u, aim_v)).unwrap();
        let across = aim.direction.cross(right);
        prop_assume!(across.length() > 0.05);
        let inside = Intrinsics::pinhole(120, 90, focal);
        let turned = camera.turned(aim.direction, right, inside).unwrap();
        turned.validate().unwrap();
        prop_assert!((turned.centre() - camera.centre()).length() < 1e-9);
        // The axis goes where it was aimed, and the image's x along `right`.
        let middle = turned.project(aim.origin + aim.direction * far).unwrap();
        prop_assert!((middle - inside.principal_point()).length() < 1e-6);
        prop_assert!(turned.extrinsics.rotation.row(0).dot(right) > 0.0);
        prop_assert!(turned.extrinsics.rotation.row(1).dot(right).abs() < 1e-9);
        // Map and projection of a point in space agree, both ways.
        let pixel = pixel_of(&camera, u, v);
        let ray = camera.unproject(pixel).unwrap();
        let map = PixelMap::between(&camera, &turned);
        let Some(seen) = turned.project(ray.origin + ray.direction * far) else {
            prop_assert_eq!(map.map(pixel), None);
            return Ok(());
        };
        let mapped = map.map(pixel).unwrap();
        prop_assert!((mapped - seen).length() < 1e-6 * (1.0 + seen.length()));
        let back = map.inverse().map(seen).unwrap();
        prop_assert!((back - pixel).length() < 1e-5, "{back} is not {pixel}");
    }

    #[test]
    fn rays_that_meet_are_triangulated_exactly(
        point in vectors(500.0),
        centres in prop::collection::vec(vectors(2000.0), 2..6), shift in vectors(1.0),
    ) {
        let ray = |&origin: &DVec3| Ray { origin, direction: (point - origin).normalize_or(DVec3::X) };
        let mut rays: Vec<Ray> = centres.iter().map(ray).collect();
        prop_assume!(centres.iter().all(|&origin| (point - origin).length() > 50.0));
        prop_assume!(rays[0].direction.cross(rays[1].direction).length() > 0.05);
        let met = triangulate(&rays).unwrap();
        prop_assert!((met.point - point).length() < 1e-7 && met.spread < 1e-7, "{met:?}");
        // Of rays that do not meet, no point near the nearest is nearer.
        rays[0].origin += shift;
        let nearest = triangulate(&rays).unwrap();
        let cost = |at: DVec3| -> f64 {
            rays.iter().map(|r| (at - r.origin).cross(r.direction).length_squared()).sum()
        };
        let least = cost(nearest.point);
        prop_assert!((nearest.spread.powi(2) * rays.len() as f64 - least).abs() < 1e-6);
        for step in [DVec3::X, DVec3::Y, DVec3::Z] {
            prop_assert!(cost(nearest.point + 0.1 * step) > least);
            prop_assert!(cost(nearest.point - 0.1 * step) > least);
        }
    }

    #[test]
    fn toml_reads_back_exactly(camera in cameras(), far in 100.0..900.0, size in 1.0..400.0,
                               q in rotations()) {
        prop_assume!(camera.validate().is_ok() && reaches_corners(&camera));
        let ray = camera.unproject(camera.intrinsics.principal_point()).unwrap();
        let volume = Volume {
            center: ray.origin + ray.direction * far,
            size: DVec3::splat(size),
            forearm: q * DVec3::Z * 3.0,
            up: q * DVec3::new(0.1, 1.0, 0.2),
        };
        let other = Camera { name: "d".into(), ..camera.clone() };
        let rig = Rig { cameras: vec![camera, other], volume };
        prop_assert_eq!(Rig::from_toml(&rig.to_toml().unwrap()).unwrap(), rig);
    }

    #[test]
    fn rest_frame_is_a_rotation_with_z_along_the_forearm(
        forearm in vectors(2.0), up in vectors(2.0), center in vectors(500.0),
    ) {
        let volume = Volume { center, size: DVec3::ONE, forearm, up };
        prop_assume!(volume.validate().is_ok());
        let frame = volume.rest_frame();
        let m = frame.matrix3;
        prop_assert!(m.transpose().abs_diff_eq(m.inverse(), 1e-9) && m.determinant() > 0.0);
        prop_assert!((m.z_axis - forearm.normalize()).length() < 1e-9);
        prop_assert!(m.y_axis.dot(up) > 0.0 && m.x_axis.dot(up).abs() < 1e-9);
        prop_assert_eq!(frame.transform_point3(DVec3::ZERO), center);
    }
}

#[test]
fn windows_beyond_the_image_are_refused() {
    let inside = Intrinsics::pinhole(120, 90, 100.0);
    for (x, y, w, h) in [(0, 0, 121, 90), (1, 0, 120, 90), (0, 0, 0, 9), (u32::MAX, 0, 2, 2)] {
        assert!(inside.cropped(x, y, w, h).is_err(), "{w}×{h} at {x}, {y}");
    }
    assert_eq!(inside.cropped(0, 0, 120, 90), Ok(inside));
}

#[test]
fn a_point_beyond_the_fold_is_not_seen() {
    let distortion = Distortion { k1: -0.3, ..Distortion::NONE };
    let lens = distortion.into();
    let intrinsics = Intrinsics { lens, ..Intrinsics::pinhole(640, 480, 600.0) };
    // Without the check the lens would put it back near the middle of the picture.
    let folded = DVec2::new(1.8, 0.0);
    assert!(distortion.distort(folded).length() < 0.1);
    assert_eq!(intrinsics.to_pixel(folded), None);
}

#[test]
fn rays_without_a_nearest_point_are_refused() {
    let ray = |x: f64, direction| Ray { origin: DVec3::new(x, 0.0, 0.0), direction };
    let [ahead, nan] = [DVec3::Z, DVec3::NAN];
    assert_eq!(triangulate(&[ray(0.0, ahead)]), Err(Error::TooFewRays { found: 1 }));
    assert_eq!(triangulate(&[ray(0.0, ahead), ray(9.0, ahead)]), Err(Error::ParallelRays));
    assert_eq!(triangulate(&[ray(0.0, ahead), ray(9.0, nan)]), Err(Error::ParallelRays));
}

#[test]
fn cameras_are_not_turned_to_nowhere() {
    let inside = Intrinsics::pinhole(120, 90, 100.0);
    let camera = Camera::look_at("c", inside, DVec3::ZERO, DVec3::Z, DVec3::Y).unwrap();
    for (ahead, right) in [
        (DVec3::ZERO, DVec3::X),
        (DVec3::Z, DVec3::ZERO),
        (DVec3::Z, DVec3::NEG_Z),
        (DVec3::NAN, DVec3::X),
    ] {
        let turned = camera.turned(ahead, right, inside);
        assert!(matches!(turned, Err(Error::VirtualAxis { .. })), "{turned:?}");
    }
}

/// Found by `undistort_finds_whatever_distort_made`: the first step from the middle leaps to the fold.
#[test]
fn points_near_the_fold_are_found() {
    let lens = |k1, k2, k3, p1, p2| Distortion { k1, k2, p1, p2, k3, ..Distortion::NONE };
    for (lens, point) in [
        (
            lens(0.119_061_038, 0.018_231_008_6, -0.019_169_089_2, 0.003_704_203_3, -0.001_380_104),
            DVec2::new(0.519_179_263, -1.344_453_055),
        ),
        (
            lens(
                0.228_298_087,
                -0.063_081_084_4,
                -0.002_315_830_9,
                -0.002_419_158_8,
                0.001_404_360_7,
            ),
            DVec2::new(-0.766_029_576, 1.224_257_758),
        ),
        (
            lens(0.250_607_735_3, -0.078_465_210_2, -0.012_591_397_7, -0.002_928_558_9, 0.0),
            DVec2::new(-0.280_624_459, 1.253_373_002),
        ),
    ] {
        let back = lens.undistort(lens.distort(point)).expect("short of the fold");
        assert!((back - point).length() < 1e-9, "{back} is not {point}");
    }
}

/// Found at random: the radius still grows there, but it is seen beyond the horizon of the tilted sensor.
#[test]
fn a_tilted_sensors_horizon_may_come_before_the_fold() {
    let (k3, k4, k5, k6) = (0.0182, -0.1862, 0.0548, -0.00484);
    let straight = Distortion { k3, k4, k5, k6, ..Distortion::NONE };
    let tilted = Distortion { tau_y: 0.012, ..straight };
    let point = DVec2::new(-2.73, -1.34);
    assert!(straight.is_one_to_one_at(point) && !tilted.is_one_to_one_at(point));
    let seen = straight.distort(point).length();
    assert!(seen > nearest_horizon(&Lens::from(tilted)), "{seen}");
    assert!(tilted.is_one_to_one_at(-point), "the horizon is on one side");
}
