//! What changes nothing: where the hand is in the picture, how large, and which way up.

use glam::{DMat3, DVec3};
use phalanx::{
    Describer, Estimator, OrientationRule, Picture, Workspace, draw_silhouette, working_camera,
};
use phalanx_camera::{Camera, Extrinsics};
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_render::Renderer;
use phalanx_segmentation::{Mask, Silhouette};

use super::desk::{
    ESTIMATOR, FROM_TOP, UNTURNED, closing, difference_deg, estimate, masks, mean, resized, rig,
    top, unseen,
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
                .map(|camera| {
                    Mask::from(Renderer::new(camera).unwrap().silhouette(&solids).unwrap())
                })
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
fn moved_down(mask: &Mask, rows: i64) -> Mask {
    Mask::from_fn(mask.width(), mask.height(), |x, y| {
        let row = i64::from(y) - rows;
        let inside = (0..i64::from(mask.height())).contains(&row);
        inside && mask.is_hand(x, row as u32)
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

fn rolled_mask(pose: &Pose, degrees: f64) -> Mask {
    let camera = working_camera(&rolled(&top().cameras[0], degrees)).unwrap();
    draw_silhouette(&camera, &HandShape::adult(), pose, &top().volume.rest_frame()).unwrap()
}

/// Open, closing, closed and pointing hands, some with their thumbs up.
fn dozen() -> Vec<Pose> {
    let mut poses: Vec<_> =
        (0..9).map(|k| closing(f64::from(k) / 8.0, 11.0 * f64::from(k))).collect();
    for theta_z in [0.0, 40.0, 80.0] {
        let mut pointing = closing(1.0, theta_z);
        for dof in [Dof::IndexMcp, Dof::IndexPip, Dof::IndexDip] {
            pointing[dof] = 0.0;
        }
        poses.push(pointing);
    }
    poses
}

#[test]
fn the_forearms_axis_turns_with_the_picture_and_the_scale_stays() {
    /// Angle in degrees, and mean distance of the points.
    fn seen(pose: &Pose, degrees: f64) -> (f64, f64) {
        let silhouette = Silhouette::from_mask(&rolled_mask(pose, degrees)).unwrap();
        let mut describer = Describer::default();
        let contexts = describer.contexts(&silhouette, OrientationRule::ForearmAxis).unwrap();
        let [x, y] = contexts.axis(0);
        (y.atan2(x).to_degrees(), contexts.mean_distance())
    }
    // At 30° the border is further away along the forearm.
    for (degrees, most_percent) in [(10.0, 1.5), (20.0, 1.5), (30.0, 4.0)] {
        let change_percent = |(pose, degrees): (Pose, f64)| {
            let (angle, scale) = seen(&pose, 0.0);
            let (turned, rescaled) = seen(&pose, degrees);
            let off = turned - angle - degrees;
            assert!(off.abs() < 1.0, "rolled by {degrees}°: {off:.2}° off");
            100.0 * (rescaled / scale - 1.0).abs()
        };
        let both_ways: Vec<_> =
            dozen().into_iter().flat_map(|pose| [(pose, -degrees), (pose, degrees)]).collect();
        let change = mean(both_ways.into_iter().map(change_percent));
        assert!(change < most_percent, "rolled by {degrees}°: {change:.1} %");
    }
}

#[test]
fn estimates_turn_with_the_picture() {
    for degrees in [-20.0, -10.0, 10.0, 20.0] {
        let error = |estimator: &Estimator| {
            let error = |pose| {
                let found = estimate(estimator, &[rolled_mask(&pose, degrees)]).unwrap();
                difference_deg(&found.pose, &pose)
            };
            mean(unseen().into_iter().map(error))
        };
        let (turned, unturned) = (error(&FROM_TOP), error(&UNTURNED));
        // Not exactly invariant: pixels, and how much of the forearm is seen.
        assert!(turned < 2.5, "rolled by {degrees}°: {turned:.2} degrees");
        assert!(
            unturned > 2.0 * turned,
            "rolled by {degrees}°: {turned:.2}, {unturned:.2} degrees"
        );
    }
}
