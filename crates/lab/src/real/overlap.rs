//! How much of what a camera saw a found hand covers.

use std::collections::BTreeMap;

use anyhow::Result;
use glam::DVec2;
use image::{GrayImage, Luma};
use imageproc::definitions::Image;
use imageproc::region_labelling::{Connectivity, connected_components};
use phalanx_camera::Camera;
use phalanx_render::Renderer;

use super::method::Found;

/// How far behind the wrist the arm counts, mm.
const ARM_MM: f64 = 35.0;

/// The middle finger's knuckle.
const KNUCKLE: usize = 9;

/// The silhouette of a found hand in a camera's picture.
///
/// # Errors
/// A hand that reaches behind the camera.
pub fn draw(camera: &Camera, found: &Found) -> Result<GrayImage> {
    Ok(Renderer::new(camera)?.silhouette(&found.solids)?)
}

/// Intersection over union of a found hand and what of a mask it covers: of several things in the mask the
/// one that the hand covers most of, and of both only what is ahead of a line across the arm behind the
/// found wrist. The mask has the size of the camera's picture.
pub fn overlap(camera: &Camera, found: &Found, drawn: &GrayImage, mask: &GrayImage) -> f64 {
    let components = connected_components(&two_levels(mask), Connectivity::Eight, Luma([0]));
    let Some(hand) = most_covered(&components, drawn) else { return 0.0 };
    let is_ahead = ahead_of_the_arm(camera, found);
    let (mut both, mut either) = (0_u32, 0_u32);
    for ((x, y, drawn), component) in drawn.enumerate_pixels().zip(components.pixels()) {
        let (drawn, seen) = (drawn.0[0] > 127, component.0[0] == hand);
        if (drawn || seen) && is_ahead(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)) {
            both += u32::from(drawn && seen);
            either += 1;
        }
    }
    f64::from(both) / f64::from(either.max(1))
}

/// The mask with two levels only: a hand is 255, anything else 0.
fn two_levels(mask: &GrayImage) -> GrayImage {
    let level = |x, y| Luma([if mask.get_pixel(x, y).0[0] > 127 { 255 } else { 0 }]);
    GrayImage::from_fn(mask.width(), mask.height(), level)
}

/// The component of which the drawn hand covers most pixels.
fn most_covered(components: &Image<Luma<u32>>, drawn: &GrayImage) -> Option<u32> {
    let mut covered = BTreeMap::new();
    for (component, drawn) in components.pixels().zip(drawn.pixels()) {
        if component.0[0] > 0 && drawn.0[0] > 127 {
            *covered.entry(component.0[0]).or_insert(0_u32) += 1;
        }
    }
    covered.into_iter().max_by_key(|&(_, pixels)| pixels).map(|(component, _)| component)
}

/// Whether a pixel is not behind the line across the arm; all are where the arm points at the camera.
fn ahead_of_the_arm(camera: &Camera, found: &Found) -> impl Fn(DVec2) -> bool {
    let wrist = found.joints[0];
    let along = (found.joints[KNUCKLE] - wrist).normalize_or_zero();
    let cut = camera.project(wrist - ARM_MM * along);
    let ahead =
        camera.project(wrist).zip(cut).map(|(wrist, cut)| (wrist - cut).normalize_or_zero());
    move |pixel| match (cut, ahead) {
        (Some(cut), Some(ahead)) => (pixel - cut).dot(ahead) >= 0.0,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};
    use phalanx_camera::Intrinsics;
    use phalanx_hand::{HandShape, Pose};

    use super::*;

    fn above() -> Camera {
        let inside = Intrinsics::pinhole(160, 120, 150.0);
        let place = DVec3::new(0.0, 500.0, 60.0);
        Camera::look_at("above", inside, place, DVec3::new(0.0, 0.0, 60.0), DVec3::X).unwrap()
    }

    fn open_hand() -> Found {
        Found::posed(&HandShape::adult(), &Pose::REST, &DAffine3::IDENTITY)
    }

    #[test]
    fn a_hand_covers_itself_whatever_else_is_seen() {
        let (camera, found) = (above(), open_hand());
        let drawn = draw(&camera, &found).unwrap();
        assert_eq!(overlap(&camera, &found, &drawn, &drawn), 1.0);
        let mut mask = drawn.clone();
        for y in 0..20 {
            for x in 0..20 {
                mask.put_pixel(x, y, Luma([255])); // a face in a corner
            }
        }
        assert_eq!(drawn.get_pixel(20, 20).0[0], 0, "the face is apart from the hand");
        assert_eq!(overlap(&camera, &found, &drawn, &mask), 1.0);
    }

    #[test]
    fn nothing_is_covered_of_an_empty_mask() {
        let (camera, found) = (above(), open_hand());
        let drawn = draw(&camera, &found).unwrap();
        assert_eq!(overlap(&camera, &found, &drawn, &GrayImage::new(160, 120)), 0.0);
    }

    #[test]
    fn where_the_arm_ends_does_not_matter() {
        let (camera, found) = (above(), open_hand());
        let drawn = draw(&camera, &found).unwrap();
        let [cut, wrist] = [-50.0, 0.0].map(|z| camera.project(DVec3::new(0.0, 0.0, z)).unwrap());
        let mut mask = drawn.clone();
        for (x, y, level) in mask.enumerate_pixels_mut() {
            if (DVec2::new(f64::from(x), f64::from(y)) - cut).dot(wrist - cut) < 0.0 {
                *level = Luma([0]); // a sleeve
            }
        }
        assert!(mask != drawn, "the arm is longer than that");
        assert_eq!(overlap(&camera, &found, &drawn, &mask), 1.0);
    }
}
