//! Silhouettes against rays, areas, points and projected dots.

use crate::property;
use crate::strategies::{camera, cylinders, lenses, solids, spheres, unit_vectors};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use image::GrayImage;
use phalanx_camera::{Camera, Distortion, Extrinsics, Intrinsics, Lens};
use phalanx_hand::{Primitive, Sphere};
use phalanx_render::{Renderer, Supersampling};
use proptest::prelude::*;

pub(crate) fn lens(lens: impl Into<Lens>) -> Camera {
    camera(Intrinsics { lens: lens.into(), ..Intrinsics::pinhole(120, 90, 110.0) })
}

pub(crate) fn silhouette(camera: &Camera, solids: &[Primitive]) -> GrayImage {
    Renderer::new(camera).unwrap().silhouette(solids).unwrap()
}

/// The silhouette of the same scene moved in the image by a little.
fn shifted(camera: &Camera, solids: &[Primitive], by: DVec2) -> GrayImage {
    let Intrinsics { cx, cy, .. } = camera.intrinsics;
    let moved = Intrinsics { cx: cx + by.x, cy: cy + by.y, ..camera.intrinsics };
    silhouette(&camera.with_intrinsics(moved), solids)
}

/// Asserts that silhouette and rays agree but within 0.02 px of the outline.
pub(crate) fn assert_like_rays(camera: &Camera, solids: &[Primitive]) {
    let mask = silhouette(camera, solids);
    let depth = Renderer::new(camera).unwrap().depth(solids).unwrap();
    let rays: Vec<u8> = depth.depths.iter().map(|z| if z.is_finite() { 255 } else { 0 }).collect();
    if rays == *mask.as_raw() {
        return;
    }
    let around: Vec<GrayImage> = (0..8u32)
        .map(|i| DVec2::from_angle(f64::from(i) * std::f64::consts::FRAC_PI_4) * 0.02)
        .map(|by| shifted(camera, solids, by))
        .collect();
    for (i, (&pixel, &ray)) in mask.as_raw().iter().zip(&rays).enumerate() {
        let on_edge = around.iter().any(|moved| moved.as_raw()[i] != pixel);
        assert!(pixel == ray || on_edge, "pixel {}, {} is not at the edge", i % 120, i / 120);
    }
}

fn mean(image: &GrayImage) -> f64 {
    image.iter().map(|&grey| f64::from(grey)).sum::<f64>() / (255.0 * image.len() as f64)
}

/// The mean position of what an image shows, px.
fn centroid(image: &GrayImage) -> DVec2 {
    let weighted = image.enumerate_pixels().map(|(x, y, grey)| {
        (DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5), f64::from(grey.0[0]))
    });
    let (sum, weight) = weighted
        .fold((DVec2::ZERO, 0.0), |(sum, weight), (at, grey)| (sum + at * grey, weight + grey));
    sum / weight
}

/// Points on and in a solid: on spheres between its own.
fn points(solid: &Primitive, count: u32) -> impl Iterator<Item = DVec3> {
    let spheres = solid.spheres().to_vec();
    let squash = solid.squash();
    // Three low-discrepancy sequences (multiples of powers of an irrational number).
    let share = |i: u32, step: f64| (f64::from(i) * step).fract();
    (0..count).map(move |i| {
        let (first, last) = (spheres[0], spheres[spheres.len() - 1]);
        let between = (share(i, 0.819_172_513_4) * 1.5 - 0.25).clamp(0.0, 1.0);
        let height = 2.0 * share(i, 0.671_043_606_7) - 1.0;
        let around = DVec2::from_angle(std::f64::consts::TAU * share(i, 0.549_700_477_9));
        let outward = (around * (1.0 - height * height).sqrt()).extend(height);
        let radius = first.radius + (last.radius - first.radius) * between;
        let point = first.center.lerp(last.center, between) + outward * radius;
        first.center + squash * (point - first.center)
    })
}

proptest! {
    #![proptest_config(property::cases(100))]

    #[test]
    fn silhouettes_are_what_rays_meet(
        solids in prop::collection::vec(solids(90.0), 1..4), distortion in lenses(),
    ) {
        assert_like_rays(&lens(distortion), &solids);
    }

    /// Solids that leave the picture by far, where a lens may have folded over.
    #[test]
    fn what_leaves_the_picture_does_not_come_back(
        solid in solids(900.0), k1 in -0.25..-0.1,
    ) {
        let camera = lens(Distortion { k1, ..Distortion::NONE });
        assert_like_rays(&camera, &[solid]);
    }

    #[test]
    fn a_union_is_the_brighter_of_both(
        a in solids(90.0), b in solids(90.0), distortion in lenses(),
    ) {
        let camera = lens(distortion);
        let mut both = silhouette(&camera, &[a]);
        let other = silhouette(&camera, &[b]);
        both.iter_mut().zip(other.iter()).for_each(|(grey, &more)| *grey = (*grey).max(more));
        prop_assert!(both == silhouette(&camera, &[a, b]));
    }

    #[test]
    fn one_sample_a_pixel_is_the_silhouette(solid in solids(90.0), distortion in lenses()) {
        let mut renderer = Renderer::new(&lens(distortion)).unwrap();
        let coverage = renderer.coverage(&[solid], Supersampling::X1).unwrap();
        prop_assert!(coverage == renderer.silhouette(&[solid]).unwrap());
    }

    #[test]
    fn coverage_adds_up_to_the_area(sphere in spheres(40.0)) {
        let camera = lens(Lens::PERFECT);
        let image = Renderer::new(&camera)
            .unwrap()
            .coverage(&[Primitive::Sphere(sphere)], Supersampling::X8)
            .unwrap();
        // A sphere of radius r at distance d and depth z has the half-axes
        // f r √(d² − r²) / (z² − r²) and f r / √(z² − r²).
        let c = camera.extrinsics.to_camera(sphere.center);
        let squared = sphere.radius * sphere.radius;
        let narrow = c.z * c.z - squared;
        let long = 110.0 * sphere.radius * (c.length_squared() - squared).sqrt() / narrow;
        let short = 110.0 * sphere.radius / narrow.sqrt();
        let area = std::f64::consts::PI * long * short;
        let drawn = mean(&image) * f64::from(120 * 90);
        prop_assert!((drawn - area).abs() < 0.01 * area + 0.15, "{drawn} px², not {area}");
    }

    #[test]
    fn a_dot_lands_where_it_projects(
        x in -60.0..60.0, y in -45.0..45.0, z in -50.0..50.0, distortion in lenses(),
        (left, top) in (0u32..20, 0u32..15), (width, height) in (150u32..300, 150u32..300),
    ) {
        let point = DVec3::new(x, y, z);
        let dot = [Primitive::Sphere(Sphere::new(point, 3.0))];
        let whole = lens(distortion);
        let cropped = whole.intrinsics.cropped(left, top, 100, 75).unwrap();
        let resized = cropped.resized(width, height);
        for intrinsics in [whole.intrinsics, cropped, resized] {
            let camera = whole.with_intrinsics(intrinsics);
            let pixel = camera.project(point).unwrap();
            let size = DVec2::new(f64::from(intrinsics.width), f64::from(intrinsics.height));
            let margin = DVec2::splat(8.0);
            if pixel.cmplt(margin).any() || pixel.cmpgt(size - margin).any() {
                continue;
            }
            let mut renderer = Renderer::new(&camera).unwrap();
            let seen = centroid(&renderer.coverage(&dot, Supersampling::X8).unwrap());
            prop_assert!((seen - pixel).length() < 0.1, "{seen}, not {pixel}");
        }
    }

    #[test]
    fn a_squashed_cylinder_covers_its_points_and_no_more(solid in cylinders(40.0)) {
        let camera = lens(Lens::PERFECT);
        let mask = silhouette(&camera, &[solid]);
        // What is thinner than a pixel passes between the middles of pixels.
        let mut renderer = Renderer::new(&camera).unwrap();
        let covered = renderer.coverage(&[solid], Supersampling::X8).unwrap();
        let mut touched = GrayImage::new(120, 90);
        for point in points(&solid, 40_000) {
            let pixel = camera.project(point).unwrap();
            if camera.intrinsics.contains(pixel) {
                let (x, y) = ((pixel.x as u32).min(119), (pixel.y as u32).min(89));
                touched.put_pixel(x, y, image::Luma([255]));
            }
        }
        let near = |image: &GrayImage, x: u32, y: u32| {
            let (columns, rows) = (x.max(1) - 1..(x + 2).min(120), y.max(1) - 1..(y + 2).min(90));
            rows.flat_map(|v| columns.clone().map(move |u| (u, v)))
                .any(|(u, v)| image.get_pixel(u, v).0[0] > 0)
        };
        for (x, y, grey) in mask.enumerate_pixels() {
            let missed = grey.0[0] > 0 && !near(&touched, x, y);
            prop_assert!(!missed, "{x}, {y} is covered but no point is near");
            let spilt = touched.get_pixel(x, y).0[0] > 0 && !near(&covered, x, y);
            prop_assert!(!spilt, "a point at {x}, {y} is far from the silhouette");
        }
    }

    #[test]
    fn moving_camera_and_solids_together_changes_nothing(
        solid in solids(60.0), axis in unit_vectors(), angle in -3.0..3.0,
        x in -500.0..500.0, y in -500.0..500.0, z in -500.0..500.0,
    ) {
        let camera = lens(Lens::PERFECT);
        let turn = DQuat::from_axis_angle(axis, angle);
        let motion = DAffine3::from_rotation_translation(turn, DVec3::new(x, y, z));
        let back = motion.inverse();
        let moved = Camera {
            extrinsics: Extrinsics {
                rotation: camera.extrinsics.rotation * back.matrix3,
                translation: camera.extrinsics.to_camera(back.translation),
            },
            ..camera.clone()
        };
        let (here, there) = (silhouette(&camera, &[solid]), silhouette(&moved, &[solid.moved(&motion)]));
        // Rounding may move a pixel's centre across the outline.
        let changed = here.iter().zip(there.iter()).filter(|(a, b)| a != b).count();
        prop_assert!(changed <= 1, "{changed} pixels changed");
    }
}

#[test]
fn coarse_outlines_lose_no_more_than_they_may() {
    let camera = lens(Lens::PERFECT);
    let sphere = [Primitive::Sphere(Sphere::new(DVec3::new(3.0, -2.0, 300.0), 80.0))];
    let drawn = |deviation: f64| {
        let mut renderer = Renderer::new(&camera).unwrap().with_deviation(deviation).unwrap();
        mean(&renderer.coverage(&sphere, Supersampling::X8).unwrap())
    };
    let pixels = 120.0 * 90.0;
    let (fine, coarse) = (drawn(0.001) * pixels, drawn(0.2) * pixels);
    let outline = std::f64::consts::TAU * (fine / std::f64::consts::PI).sqrt();
    let lost = (fine - coarse) / outline;
    assert!((0.05..=0.2).contains(&lost), "{lost} px on average");
}

#[test]
fn an_image_of_another_size_is_replaced() {
    let mut renderer = Renderer::new(&lens(Lens::PERFECT)).unwrap();
    let sphere = [Primitive::Sphere(Sphere::new(DVec3::ZERO, 20.0))];
    let mut image = GrayImage::from_pixel(3, 5, image::Luma([9]));
    renderer.silhouette_into(&sphere, &mut image).unwrap();
    assert_eq!(image, renderer.silhouette(&sphere).unwrap());
    renderer.silhouette_into(&[], &mut image).unwrap();
    assert_eq!(image, GrayImage::new(120, 90));
}
