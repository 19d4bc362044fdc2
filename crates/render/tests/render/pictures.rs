//! Depth, shaded pictures, and what is refused.

use crate::property;
use crate::strategies::camera;
use glam::DVec3;
use image::{Rgb, RgbImage};
use phalanx_camera::{Camera, Intrinsics};
use phalanx_hand::{Primitive, Sphere};
use phalanx_render::{Appearance, Background, Error, Renderer, Supersampling};
use proptest::prelude::*;

const SPHERE: Primitive = Primitive::Sphere(Sphere::new(DVec3::ZERO, 30.0));

fn renderer() -> Renderer {
    Renderer::new(&camera(Intrinsics::pinhole(120, 90, 110.0))).unwrap()
}

/// No noise, no highlight, hard edges.
fn plain() -> Appearance {
    Appearance {
        specular: 0.0,
        noise_sigma: 0.0,
        sampling: Supersampling::X1,
        ..Appearance::default()
    }
}

#[test]
fn depth_is_along_the_axis() {
    // The camera stands 300 mm in front; a wide flat wedge faces it.
    let flat = [[-900.0, -900.0], [900.0, -900.0], [0.0, 1500.0]]
        .map(|[x, y]| Sphere::new(DVec3::new(x, y, 0.0), 10.0));
    let map = renderer().depth(&[Primitive::Wedge(flat)]).unwrap();
    assert_eq!((map.width, map.height, map.depths.len()), (120, 90, 120 * 90));
    assert!(map.depths.iter().all(|z| (z - 290.0).abs() < 1e-3));
    // An odd size puts a pixel's centre on the axis.
    let mut odd = Renderer::new(&camera(Intrinsics::pinhole(121, 91, 110.0))).unwrap();
    let map = odd.depth(&[SPHERE]).unwrap();
    assert!((map.depths[45 * 121 + 60] - 270.0).abs() < 1e-3);
    assert_eq!(map.depths[0], f32::INFINITY);
}

#[test]
fn fully_ambient_skin_is_one_colour() {
    let look = Appearance { ambient: 1.0, ..plain() };
    let picture = renderer().shade(&[SPHERE], &look, 1).unwrap();
    let depth = renderer().depth(&[SPHERE]).unwrap();
    for (pixel, z) in picture.pixels().zip(&depth.depths) {
        let wanted = if z.is_finite() { look.skin } else { [84, 98, 112] };
        assert_eq!(pixel.0, wanted);
    }
}

#[test]
fn the_side_towards_the_light_is_brighter() {
    let lit_from =
        |light| renderer().shade(&[SPHERE], &Appearance { light, ..plain() }, 1).unwrap();
    let red = |picture: &RgbImage, x, y| picture.get_pixel(x, y).0[0];
    // World x is to the right of the image and y down it.
    let right = lit_from(DVec3::X);
    assert!(red(&right, 68, 45) > red(&right, 52, 45) + 40);
    let below = lit_from(DVec3::Y * 7.0);
    assert!(red(&below, 60, 53) > red(&below, 60, 37) + 40);
    let ahead = lit_from(DVec3::NEG_Z);
    assert_eq!(ahead.get_pixel(60, 45).0, plain().skin);
}

#[test]
fn edges_mix_with_the_background_by_coverage() {
    let black = Appearance {
        ambient: 1.0,
        skin: [255; 3],
        background: Background::Plain([0; 3]),
        sampling: Supersampling::X8,
        ..plain()
    };
    let picture = renderer().shade(&[SPHERE], &black, 1).unwrap();
    let coverage = renderer().coverage(&[SPHERE], Supersampling::X8).unwrap();
    let differences = picture.pixels().zip(coverage.pixels()).map(|(a, b)| a.0[0].abs_diff(b.0[0]));
    // The outline may be 0.01 px off, which is at most one row of a pixel's 8 × 8 samples.
    assert!(differences.clone().all(|difference| difference <= 32));
    assert!(differences.map(u32::from).sum::<u32>() < 300);
}

#[test]
fn backgrounds_are_kept() {
    let picture = RgbImage::from_fn(120, 90, |x, y| Rgb([x as u8, y as u8, 7]));
    let look = Appearance { background: Background::Picture(picture.clone()), ..plain() };
    assert_eq!(renderer().shade(&[], &look, 1).unwrap(), picture);
    let background = Background::Gradient { top: [0, 100, 200], bottom: [89, 11, 200] };
    let fading = renderer().shade(&[], &Appearance { background, ..plain() }, 1).unwrap();
    assert!((0..90).all(|y| fading.get_pixel(3, y).0 == [y as u8, 100 - y as u8, 200]));
}

#[test]
fn noise_has_its_strength_and_its_seed() {
    let look = Appearance {
        background: Background::Plain([120; 3]),
        noise_sigma: 5.0,
        ..Appearance::default()
    };
    let picture = renderer().shade(&[SPHERE], &look, 7).unwrap();
    assert_eq!(picture, renderer().shade(&[SPHERE], &look, 7).unwrap());
    assert_ne!(picture, renderer().shade(&[SPHERE], &look, 8).unwrap());
    let empty = renderer().shade(&[], &look, 7).unwrap();
    let count = empty.len() as f64;
    let off =
        |power| empty.iter().map(|&c| (f64::from(c) - 120.0).powi(power)).sum::<f64>() / count;
    // 32,400 samples: the mean is within 0.03 and the deviation within 0.02, each once.
    assert!(off(1).abs() < 0.15, "mean {}", off(1));
    assert!((off(2).sqrt() - 5.0).abs() < 0.1, "deviation {}", off(2).sqrt());
    assert!((off(4) / off(2).powi(2) - 3.0).abs() < 0.2, "not Gaussian");
}

#[test]
fn bad_appearances_are_refused_by_name() {
    let refused = |look: Appearance| match renderer().shade(&[], &look, 1) {
        Err(Error::Appearance { field }) => field,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(Appearance { light: DVec3::ZERO, ..plain() }), "light");
    assert_eq!(refused(Appearance { light: DVec3::NAN, ..plain() }), "light");
    assert_eq!(refused(Appearance { ambient: 1.1, ..plain() }), "ambient");
    assert_eq!(refused(Appearance { specular: f64::NAN, ..plain() }), "specular");
    assert_eq!(refused(Appearance { noise_sigma: -1.0, ..plain() }), "noise_sigma");
    let look = Appearance { background: Background::Picture(RgbImage::new(9, 8)), ..plain() };
    let error = Error::BackgroundSize { have: (9, 8), want: (120, 90) };
    assert_eq!(renderer().shade(&[], &look, 1), Err(error));
}

#[test]
fn bad_solids_are_refused_by_index() {
    let sphere = |x: f64, radius: f64| Sphere::new(DVec3::new(x, 0.0, 0.0), radius);
    let squashed = |thin_axis: DVec3, flatness: f64| Primitive::GeneralisedCylinder {
        ends: [sphere(0.0, 5.0), sphere(20.0, 5.0)],
        thin_axis,
        flatness,
    };
    for (solid, field) in [
        (Primitive::Sphere(sphere(f64::NAN, 5.0)), "center"),
        (Primitive::RoundCone([sphere(0.0, 5.0), sphere(f64::INFINITY, 5.0)]), "center"),
        (Primitive::Sphere(sphere(-1e34, 5.0)), "center"),
        (Primitive::Sphere(sphere(0.0, 0.0)), "radius"),
        (Primitive::Sphere(sphere(0.0, 1e34)), "radius"),
        (Primitive::Sphere(sphere(0.0, f64::INFINITY)), "radius"),
        (squashed(DVec3::ZERO, 0.5), "thin_axis"),
        (squashed(DVec3::Y * 2.0, 0.5), "thin_axis"),
        (squashed(DVec3::Y, 0.0), "flatness"),
        (squashed(DVec3::Y, 1.5), "flatness"),
        (squashed(DVec3::Y, f64::NAN), "flatness"),
    ] {
        let error = Error::Primitive { index: 1, field };
        assert_eq!(renderer().silhouette(&[SPHERE, solid]), Err(error));
    }
}

#[test]
fn deviations_out_of_range_are_refused() {
    for found in [0.0, -1.0, 1.5, f64::NAN] {
        let error = renderer().with_deviation(found).unwrap_err();
        assert!(error.to_string().contains("0.001 to 1 px"), "{error}");
    }
}

#[test]
fn bad_cameras_are_refused() {
    let mut bad: Camera = camera(Intrinsics::pinhole(120, 90, 110.0));
    bad.intrinsics.width = 0;
    assert!(matches!(Renderer::new(&bad), Err(Error::Camera(_))));
}

proptest! {
    #![proptest_config(property::cases(256))]

    /// Whatever the numbers, there is a picture or an error.
    #[test]
    fn nothing_panics(numbers in prop::collection::vec(prop_oneof![
        -1e3..1e3f64, -1e-9..1e-9f64, -1e300..1e300f64, prop::num::f64::ANY,
    ], 16)) {
        let sphere = |i: usize| {
            Sphere::new(DVec3::from_slice(&numbers[i..i + 3]), numbers[i + 3])
        };
        let solids = [
            Primitive::Sphere(sphere(0)),
            Primitive::RoundCone([sphere(0), sphere(4)]),
            Primitive::Wedge([sphere(0), sphere(4), sphere(8)]),
            Primitive::GeneralisedCylinder {
                ends: [sphere(0), sphere(4)],
                thin_axis: DVec3::from_slice(&numbers[8..11]).normalize_or(DVec3::X),
                flatness: numbers[11].abs().min(1.0),
            },
        ];
        let mut renderer = renderer();
        for solid in solids {
            let masked = renderer.silhouette(&[solid]).is_ok();
            let cast = renderer.depth(&[solid]);
            prop_assert_eq!(cast.is_ok(), masked);
            prop_assert!(cast.map_or(true, |map| map.depths.iter().all(|z| *z > 0.0)));
        }
    }
}
