//! Pictures and cameras are brought to the working size alike, and overlays go back.

use image::{Rgb, RgbImage};
use phalanx::{
    OrientationRule, WORKING_SIZE, draw_overlay, draw_silhouette, working_camera, working_window,
};
use phalanx_camera::Intrinsics;
use phalanx_hand::HandShape;
use phalanx_render::Renderer;
use phalanx_segmentation::{CropWindow, Silhouette, downsample_mask};

use super::desk::{masks, top, unseen};

#[test]
fn a_wide_picture_shrinks_to_what_the_working_camera_sees() {
    let rig = top();
    let rest = rig.volume.rest_frame();
    for (width, height, focal) in [(640, 480, 1450.0), (1920, 1080, 3200.0), (900, 1200, 2000.0)] {
        let mut intrinsics = Intrinsics::pinhole(width, height, focal);
        // Off the middle, so that it has to be carried along.
        intrinsics.cx += 31.0;
        intrinsics.cy -= 17.0;
        let camera = rig.cameras[0].with_intrinsics(intrinsics);
        for pose in unseen() {
            let solids = HandShape::adult().pose(&pose, &rest).primitives;
            let full = Renderer::new(&camera).unwrap().silhouette(&solids).unwrap().into();
            let shrunk = downsample_mask(&full, WORKING_SIZE.0, WORKING_SIZE.1).unwrap();
            let drawn = draw_silhouette(&camera, &HandShape::adult(), &pose, &rest).unwrap();
            let differing = shrunk.iter().zip(drawn.iter()).filter(|(a, b)| a != b).count();
            // Where an outline leaves a pixel's centre uncovered but covers half of it.
            assert!(differing < 40, "{width}×{height}: {differing} pixels differ");
        }
    }
}

#[test]
fn the_working_camera_sees_the_working_window() {
    let camera = top().cameras.remove(0).with_intrinsics(Intrinsics::pinhole(1920, 1080, 3200.0));
    let window = working_window((1920, 1080)).unwrap();
    assert_eq!(window, CropWindow { x: 240, y: 0, width: 1440, height: 1080 });
    let working = working_camera(&camera).unwrap();
    assert_eq!((working.intrinsics.width, working.intrinsics.height), WORKING_SIZE);
    let point = glam::DVec3::new(20.0, 5.0, 60.0);
    let (full, small) = (camera.project(point).unwrap(), working.project(point).unwrap());
    assert!((full - glam::DVec2::new(240.0, 0.0) - small * 12.0).length() < 1e-9);
}

#[test]
fn an_estimate_that_is_the_observation_covers_it() {
    const OBSERVED: Rgb<u8> = Rgb([40, 220, 90]);
    const AXIS: Rgb<u8> = Rgb([255, 210, 0]);
    const ESTIMATED: Rgb<u8> = Rgb([230, 40, 160]);
    let observed = Silhouette::from_mask(&masks(&top(), &unseen()[1])[0]).unwrap();
    let window = working_window((480, 360)).unwrap();
    let draw = |rule, estimated: Option<&Silhouette>| {
        let mut canvas = RgbImage::new(480, 360);
        draw_overlay(&mut canvas, window, &observed, rule, estimated);
        let count = |colour| canvas.pixels().filter(|pixel| **pixel == colour).count();
        [OBSERVED, AXIS, ESTIMATED].map(count)
    };
    for (rule, has_axis) in [
        (OrientationRule::ForearmAxis, true),
        (OrientationRule::HandAxis, true),
        (OrientationRule::Tangent, false),
    ] {
        let [alone, axis, none] = draw(rule, None);
        assert!(alone > 1000 && none == 0, "{alone} {none}");
        assert_eq!(axis > 300, has_axis, "{rule:?}: {axis}");
        let [left, _, covered] = draw(rule, Some(&observed));
        assert_eq!(left, 0);
        assert!(covered >= alone, "{covered} {alone}");
    }
    // Nothing was seen, there is nowhere to draw: nothing happens.
    let (mut none, nothing) = (RgbImage::new(0, 0), Silhouette::default());
    draw_overlay(&mut none, window, &observed, OrientationRule::HandAxis, Some(&nothing));
    let mut canvas = RgbImage::new(48, 36);
    draw_overlay(&mut canvas, window, &nothing, OrientationRule::ForearmAxis, Some(&observed));
    assert_eq!(canvas, RgbImage::new(48, 36));
}
