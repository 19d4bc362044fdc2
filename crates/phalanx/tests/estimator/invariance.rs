//! What changes nothing: where the hand is in the picture, how large, and which way up.

use glam::{DMat3, DVec3};
use image::{GrayImage, Luma};
use phalanx::{Estimator, Picture, Workspace, draw_silhouette, working_camera};
use phalanx_camera::{Camera, Extrinsics};
use phalanx_hand::{HandShape, Pose};
use phalanx_render::Renderer;

use crate::desk::{
    ESTIMATOR, FROM_TOP, UNTURNED, difference_deg, estimate, masks, mean, resized, rig, top, unseen,
};

#[test]
fn larger_pictures_give_nearly_the_same_pose() {
    for (width, height) in [(240, 180), (641, 480), (1024, 768)] {
        let change = |pose: Pose| {
            let rest = rig().volume.rest_frame();
            let solids = HandShape::adult().pose(&pose, &rest).primitives;
            let drawn: Vec<_> = resized(&rig(), width, height)
                .cameras
                .iter()
                .map(|camera| Renderer::new(camera).unwrap().silhouette(&solids).unwrap())
                .collect();
            let pictures: Vec<_> = drawn.iter().map(Picture::Mask).collect();
            let large = ESTIMATOR.estimate(&pictures, &mut Workspace::default()).unwrap();
            let plain = estimate(&ESTIMATOR, &masks(&rig(), &pose)).unwrap();
            difference_deg(&plain.pose, &large.pose)
        };
        // A pixel is hand where its centre is, or where half of it is: outlines move by less than
        // half a pixel.
        let change = mean(unseen().into_iter().map(change));
        assert!(change < 1.6, "{width}×{height}: {change:.2} degrees");
    }
}

#[test]
fn a_nearer_hand_gives_nearly_the_same_pose() {
    // The focal length grows, so that the silhouette does.
    for zoom in [0.9, 1.08] {
        let mut zoomed = rig();
        for camera in &mut zoomed.cameras {
            camera.intrinsics.fx *= zoom;
            camera.intrinsics.fy *= zoom;
        }
        let change = |pose| {
            let plain = estimate(&ESTIMATOR, &masks(&rig(), &pose)).unwrap();
            let found = estimate(&ESTIMATOR, &masks(&zoomed, &pose)).unwrap();
            difference_deg(&plain.pose, &found.pose)
        };
        // Shape contexts notice that more or less of the forearm is seen.
        let change = mean(unseen().into_iter().map(change));
        assert!(change < 4.0, "zoom {zoom}: {change:.2} degrees");
    }
}

/// The mask with its content moved down by some rows; what enters is background.
fn moved_down(mask: &GrayImage, rows: i64) -> GrayImage {
    GrayImage::from_fn(mask.width(), mask.height(), |x, y| {
        let row = i64::from(y) - rows;
        let inside = (0..i64::from(mask.height())).contains(&row);
        if inside { *mask.get_pixel(x, row as u32) } else { Luma([0]) }
    })
}

#[test]
fn a_shifted_silhouette_gives_the_same_pose() {
    for pose in unseen() {
        let masks = masks(&top(), &pose);
        let plain = estimate(&FROM_TOP, &masks).unwrap();
        for rows in [-5, 3, 6] {
            let found = estimate(&FROM_TOP, &[moved_down(&masks[0], rows)]).unwrap();
            let change = difference_deg(&plain.pose, &found.pose);
            // Only pairs that lie on a bin's edge may fall to its other side.
            assert!(change < 0.05, "{rows} rows: {change:.3} degrees");
        }
    }
}

/// The camera turned about its line of sight.
fn rolled(camera: &Camera, degrees: f64) -> Camera {
    let roll = DMat3::from_axis_angle(DVec3::Z, degrees.to_radians());
    let Extrinsics { rotation, translation } = camera.extrinsics;
    let extrinsics = Extrinsics { rotation: roll * rotation, translation: roll * translation };
    Camera { extrinsics, ..camera.clone() }
}

fn rolled_mask(pose: &Pose, degrees: f64) -> GrayImage {
    let camera = working_camera(&rolled(&top().cameras[0], degrees)).unwrap();
    draw_silhouette(&camera, &HandShape::adult(), pose, &top().volume.rest_frame()).unwrap()
}

#[test]
fn the_hand_axis_turns_with_the_picture() {
    for degrees in [-20.0, -10.0, 10.0, 20.0] {
        let error = |estimator: &Estimator| {
            let error = |pose| {
                let found = estimate(estimator, &[rolled_mask(&pose, degrees)]).unwrap();
                difference_deg(&found.pose, &pose)
            };
            mean(unseen().into_iter().map(error))
        };
        let (turned, unturned) = (error(&FROM_TOP), error(&UNTURNED));
        // Not exactly invariant: pixels and the cut of the forearm at the border differ.
        assert!(turned < 3.0, "rolled by {degrees}°: {turned:.2} degrees");
        assert!(
            unturned > 2.0 * turned,
            "rolled by {degrees}°: {turned:.2}, {unturned:.2} degrees"
        );
    }
}
