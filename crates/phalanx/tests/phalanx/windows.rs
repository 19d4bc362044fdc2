//! Windows on the hand: where they look, that training and use see the same through them, and that
//! shift and scale of the picture make no difference.

use std::sync::LazyLock;

use glam::{DVec2, DVec3};
use image::Luma;
use phalanx::{
    Augmentation, Describer, Estimator, FixedPoses, Framing, MaskNoise, NoProgress,
    OrientationRule, Picture, PicturedHand, Refiner, Scene, SceneDescriber, Training, ViewConfig,
    Window, WindowFinder, Workspace, initial_global,
};
use phalanx_camera::{Camera, Distortion, Intrinsics, Rig};
use phalanx_hand::{Digit, Dof, HandShape, Pose};
use phalanx_multiview::CodebookTrainer;
use phalanx_refine::{PoseFitSettings, PosePrior};
use phalanx_render::Renderer;
use phalanx_segmentation::{Cleanup, HandDetection, HandDetector, Mask, Silhouette, WristModel};
use proptest::prelude::*;

use crate::property;

const THROUGH_WINDOWS: ViewConfig =
    ViewConfig { orientation: OrientationRule::ForearmAxis, framing: Framing::Window };

fn rig() -> Rig {
    Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap()
}

/// A hand closed by a share of 0 to 1 and turned about the forearm.
fn closing(closed: f64, theta_z_deg: f64) -> Pose {
    let mut pose = Pose::REST;
    for digit in Digit::ALL {
        for (dof, degrees) in digit.dofs().into_iter().zip([0.0, 60.0, 80.0, 50.0]) {
            pose[dof] = (closed * degrees).to_radians();
        }
    }
    pose[Dof::ThetaZ] = theta_z_deg.to_radians();
    pose
}

/// Sixty poses to learn from, and some between them.
fn poses() -> Vec<Pose> {
    let stages = (0..12).map(|k| f64::from(k) / 11.0);
    stages.flat_map(|stage| [0.0, 15.0, 30.0, 45.0, 60.0].map(|z| closing(stage, z))).collect()
}

fn unseen() -> [Pose; 5] {
    [(0.04, 7.0), (0.22, 38.0), (0.41, 52.0), (0.59, 22.0), (0.95, 37.0)]
        .map(|(stage, z)| closing(stage, z))
}

/// Thirty centres and little patience: enough for so few poses.
fn training(framing: Framing) -> Training {
    let mut vocabulary =
        CodebookTrainer { centres: 30, most_samples: 4000, ..CodebookTrainer::default() };
    vocabulary.clustering.restarts = 1;
    Training { framing, vocabulary, ..Training::default() }
}

/// Learnt from those poses through windows.
static ESTIMATOR: LazyLock<Estimator> = LazyLock::new(|| {
    let training = training(Framing::Window);
    training.run(&rig(), &HandShape::adult(), &poses(), &NoProgress).unwrap()
});

/// The mask of a posed hand as a camera of any size sees it.
fn mask(camera: &Camera, pose: &Pose) -> Mask {
    let solids = HandShape::adult().pose(pose, &rig().volume.rest_frame()).primitives;
    Renderer::new(camera).unwrap().silhouette(&solids).unwrap().into()
}

/// What a camera's window shows of a mask.
fn look(camera: &Camera, mask: &Mask) -> (Window, Silhouette) {
    let mut finder = WindowFinder::default();
    let cameras = std::slice::from_ref(camera);
    let windows = finder.find(cameras, std::slice::from_ref(mask), None).unwrap();
    let mut silhouettes = [Silhouette::default()];
    finder.silhouettes(&windows, &mut silhouettes).unwrap();
    let [silhouette] = silhouettes;
    (windows[0].clone(), silhouette)
}

/// What a camera's window shows of one of the two things in a mask that look most like a hand: that whose
/// wrist is nearer to a place of the picture.
fn look_near(camera: &Camera, mask: &Mask, place: DVec2) -> Silhouette {
    let mut detector = HandDetector::default();
    let found = detector.find(mask, &Cleanup::default(), WristModel::builtin()).unwrap();
    let distance = |hand: &HandDetection| DVec2::from_array(hand.wrist).distance(place);
    let likeliest = found.iter().take(2);
    let hand = likeliest.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    let window = Window::onto(camera, hand).unwrap();
    let (mut seen, mut silhouette) = (Mask::default(), Silhouette::default());
    window.resample(&detector.isolate(hand), &mut seen);
    Describer::default().silhouette_of_mask(&seen, &mut silhouette).unwrap();
    silhouette
}

/// A wide camera above the desk, with a lens.
fn wide() -> Camera {
    let lens = Distortion { k1: -0.1, k2: 0.02, p1: 1e-3, p2: -1e-3, ..Distortion::NONE }.into();
    let intrinsics = Intrinsics { lens, ..Intrinsics::pinhole(480, 360, 420.0) };
    let (at, to) = (DVec3::new(60.0, 650.0, 20.0), DVec3::new(40.0, 0.0, 10.0));
    Camera::look_at("wide", intrinsics, at, to, DVec3::X).unwrap()
}

#[test]
fn the_hand_fills_a_fifth_and_points_to_the_right() {
    for pose in unseen() {
        let camera = wide();
        let (window, silhouette) = look(&camera, &mask(&camera, &pose));
        let hand = silhouette.mask.area() as f64;
        // With the arm, which is less than the hand.
        let share = hand / silhouette.mask.len() as f64;
        assert!((0.15..0.4).contains(&share), "{share}");
        assert_eq!(silhouette.forearm.crossings, 1);
        assert_eq!(silhouette.forearm.end[0], 0.5, "the arm comes from the left");
        let posed = HandShape::adult().pose(&pose, &rig().volume.rest_frame());
        let wrist = window.camera.project(posed.joints[0]).unwrap();
        assert!(wrist.x < 65.0 && (wrist.y - 45.0).abs() < 25.0, "{wrist}");
    }
}

#[test]
fn window_and_picture_show_the_same_points() {
    let camera = wide();
    let pose = closing(0.3, 30.0);
    let (window, _) = look(&camera, &mask(&camera, &pose));
    for joint in HandShape::adult().pose(&pose, &rig().volume.rest_frame()).joints {
        let seen = window.camera.project(joint).unwrap();
        let pictured = DVec2::from_array(window.to_picture(seen.to_array()).unwrap());
        assert!((pictured - camera.project(joint).unwrap()).length() < 1e-6);
    }
}

#[test]
fn training_and_use_see_the_same() {
    let (rig, hand) = (rig(), HandShape::adult());
    let read = Estimator::from_bytes(&ESTIMATOR.to_bytes().unwrap()).unwrap();
    assert_eq!(read, *ESTIMATOR);
    assert_eq!(read.descriptor().view_config(), THROUGH_WINDOWS);
    let mut describer = SceneDescriber::new(&rig, THROUGH_WINDOWS).unwrap();
    let (mut workspace, mut worst) = (Workspace::default(), 0.0_f64);
    for pose in unseen() {
        let scene = Scene::nominal(&rig, &hand, pose);
        let masks = describer.masks(&scene).unwrap().to_vec();
        let trained_on: Vec<Silhouette> = describer.silhouettes(&scene).unwrap().cloned().collect();
        let pictures: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
        let estimate = ESTIMATOR.estimate(&pictures, &mut workspace).unwrap();
        for (used, trained_on) in estimate.observation.silhouettes().zip(&trained_on) {
            // It was found in a smaller picture.
            assert!(used.mask.iou(&trained_on.mask) > 0.9);
        }
        for dof in [Dof::IndexPip, Dof::MiddleMcp, Dof::ThetaZ] {
            worst = worst.max((estimate.pose[dof] - pose[dof]).abs().to_degrees());
        }
    }
    assert!(worst < 20.0, "{worst}");
}

/// What windows show of a scene: drawn at once, and by way of the pictures that they look into.
fn both_ways(rig: &Rig, scene: &Scene) -> [Vec<Mask>; 2] {
    let mut describer = SceneDescriber::new(rig, THROUGH_WINDOWS).unwrap();
    let mask = |silhouette: &Silhouette| silhouette.mask.clone();
    let drawn = describer.silhouettes(scene).unwrap().map(mask).collect();
    let pictures = describer.masks(scene).unwrap().to_vec();
    let mut finder = WindowFinder::default();
    let windows = finder.find(&rig.cameras, &pictures, None).unwrap();
    let mut silhouettes = vec![Silhouette::default(); rig.cameras.len()];
    finder.silhouettes(&windows, &mut silhouettes).unwrap();
    [drawn, silhouettes.iter().map(mask).collect()]
}

/// In pictures of any size the drawn window is that of the picture, and a ragged border is as ragged.
#[test]
fn a_window_is_drawn_as_the_picture_shows_it() {
    for times in [1, 4, 8] {
        let mut rig = rig();
        for camera in &mut rig.cameras {
            camera.intrinsics = camera.intrinsics.resized(120 * times, 90 * times);
        }
        let (mut alike, mut ragged, mut views) = (0.0, [0.0; 2], 0.0);
        for (number, pose) in unseen().into_iter().enumerate() {
            let nominal = Scene::nominal(&rig, &HandShape::adult(), pose);
            let damage = Augmentation { mask_noise: MaskNoise::Boundary, ..Augmentation::NONE };
            let rough = damage.scene(&rig, &HandShape::adult(), pose, 3, number);
            let (clean, rough) = (both_ways(&rig, &nominal), both_ways(&rig, &rough));
            for view in 0..rig.cameras.len() {
                alike += clean[0][view].iou(&clean[1][view]);
                for way in 0..2 {
                    ragged[way] += 1.0 - clean[way][view].iou(&rough[way][view]);
                }
                views += 1.0;
            }
        }
        let (alike, ragged) = (alike / views, ragged.map(|share| share / views));
        assert!(alike > 0.95, "{times}: {alike}");
        assert!((ragged[0] - ragged[1]).abs() < 0.03, "{times}: {ragged:?}");
    }
}

/// Hands elsewhere, their arms leaning, as an estimator sees them that learnt from hands in the middle.
#[test]
fn hands_are_placed_and_refined_where_they_are() {
    let (rig, hand) = (rig(), HandShape::adult());
    let refiner = Refiner::for_estimator(&ESTIMATOR, PoseFitSettings::default()).unwrap();
    let mut describer = SceneDescriber::new(&rig, THROUGH_WINDOWS).unwrap();
    let mut workspace = Workspace::default();
    for (k, mut pose) in unseen().into_iter().enumerate() {
        for (j, dof) in [Dof::TX, Dof::TY, Dof::TZ].into_iter().enumerate() {
            pose[dof] = [-25.0, 0.0, 25.0][(k + j) % 3];
        }
        pose[Dof::ThetaX] = [-0.2, 0.0, 0.2][k % 3];
        let masks = describer.masks(&Scene::nominal(&rig, &hand, pose)).unwrap().to_vec();
        let pictures: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
        let estimate = ESTIMATOR.estimate(&pictures, &mut workspace).unwrap();
        let off = |pose: &Pose, truth: &Pose| pose.translation().distance(truth.translation());
        assert!(off(&estimate.pose, &pose) < 40.0, "{} mm", off(&estimate.pose, &pose));
        let evidence = refiner.evidence_of(&estimate.observation).unwrap();
        let refined = refiner.refine(&evidence, &estimate).unwrap();
        assert!(off(&refined.pose, &pose) < 5.0, "{} mm", off(&refined.pose, &pose));
        assert!(refined.ious.iter().all(|&iou| iou > 0.9), "{:?}", refined.ious);
    }
}

/// The same masks as pictures of other sizes than the rig's: hands are placed where they were.
#[test]
fn the_size_of_the_pictures_makes_no_difference() {
    let (rig, hand) = (rig(), HandShape::adult());
    let mut workspace = Workspace::default();
    let mut pose = unseen()[1];
    [pose[Dof::TX], pose[Dof::TY], pose[Dof::TZ]] = [-20.0, 10.0, 15.0];
    let mut estimate_at = |size: f64| {
        let masks: Vec<Mask> = rig
            .cameras
            .iter()
            .map(|camera| {
                let Intrinsics { width, height, .. } = camera.intrinsics;
                let [width, height] = [width, height].map(|side| (size * f64::from(side)) as u32);
                let pictured = camera.with_intrinsics(camera.intrinsics.resized(width, height));
                let solids = hand.pose(&pose, &rig.volume.rest_frame()).primitives;
                Renderer::new(&pictured).unwrap().silhouette(&solids).unwrap().into()
            })
            .collect();
        let pictures: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
        ESTIMATOR.estimate(&pictures, &mut workspace).unwrap().pose
    };
    let usual = estimate_at(1.0);
    for size in [1.5, 2.7, 4.0] {
        let other = estimate_at(size);
        let moved = usual.translation().distance(other.translation());
        // The masks' own pixels are worth some millimetres of a distance along the view.
        assert!(moved < 15.0, "×{size}: {moved} mm");
    }
}

/// A fist of which one finger points on along the arm, so that it looks like a hand on an arm of its own.
#[test]
fn a_pointing_finger_is_not_taken_for_a_hand() {
    const DEGREES: [[f64; 4]; 5] = [
        [30.0, -8.0, 18.0, 24.0],
        [4.0, 50.0, 88.0, 63.0],
        [11.0, -10.0, 6.0, 5.0],
        [5.0, 79.0, 5.0, 1.0],
        [-5.0, 85.0, 8.0, 3.0],
    ];
    let rig = rig();
    let mut pose = Pose::REST;
    for (digit, degrees) in Digit::ALL.into_iter().zip(DEGREES) {
        for (dof, degrees) in digit.dofs().into_iter().zip(degrees) {
            pose[dof] = degrees.to_radians();
        }
    }
    for (dof, degrees) in [(Dof::ThetaX, 23.6_f64), (Dof::ThetaY, 12.5), (Dof::ThetaZ, 60.5)] {
        pose[dof] = degrees.to_radians();
    }
    for (dof, mm) in [(Dof::TX, -4.0), (Dof::TY, -48.6), (Dof::TZ, -40.6)] {
        pose[dof] = mm;
    }
    let masks: Vec<Mask> = rig.cameras.iter().map(|camera| mask(camera, &pose)).collect();
    let windows = WindowFinder::default().find(&rig.cameras, &masks, None).unwrap();
    let posed = HandShape::adult().pose(&pose, &rig.volume.rest_frame());
    for (camera, window) in rig.cameras.iter().zip(windows) {
        let wrist = camera.project(posed.joints[0]).unwrap();
        let off = wrist.distance(window.hand.wrist.into());
        assert!(off < window.hand.width, "{}: the wrist is {off} px off", camera.name);
    }
}

/// A hand whose fingers reach beyond the picture is not taken for one that ends there.
#[test]
fn what_is_beyond_the_picture_is_not_known() {
    let (rig, hand) = (rig(), HandShape::adult());
    let (camera, rest) = (&rig.cameras[1], rig.volume.rest_frame());
    // So far along the arm that the picture ends across the fingers' last joints.
    let mut pose = Pose::REST;
    pose[Dof::TZ] = 75.0;
    let seen = mask(camera, &pose);
    assert!((0..seen.height()).any(|y| seen.get_pixel(seen.width() - 1, y) == &Luma([255])));
    let (window, silhouette) = look(camera, &seen);
    let evidence = [window.evidence(&silhouette).unwrap()];
    let prior = PosePrior::independent(pose, &[0.3; Dof::COUNT]).unwrap();
    let refined =
        PoseFitSettings::default().fit(&hand, &rest, &evidence[..], &pose, &prior).unwrap();
    let bent: f64 = Digit::FINGERS
        .into_iter()
        .flat_map(|digit| digit.dofs()[1..].to_vec())
        .map(|dof| refined.pose[dof].to_degrees())
        .sum();
    assert!(bent.abs() < 60.0, "the fingers bend by {bent} degrees together");
}

/// Errors are learnt of what regression tells; where the hand is, its windows say.
#[test]
fn hypotheses_are_where_the_windows_show_the_hand() {
    let (rig, hand) = (rig(), HandShape::adult());
    let poses = poses();
    let scenes = FixedPoses { rig: &rig, hand: &hand, poses: &poses };
    let estimator = ESTIMATOR.clone().fit_error_model(&scenes, &NoProgress).unwrap();
    let mut describer = SceneDescriber::new(&rig, THROUGH_WINDOWS).unwrap();
    let mut pose = closing(0.4, 20.0);
    pose[Dof::TY] = 20.0;
    let masks = describer.masks(&Scene::nominal(&rig, &hand, pose)).unwrap().to_vec();
    let pictures: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
    let estimate = estimator.estimate(&pictures, &mut Workspace::default()).unwrap();
    let hypotheses = estimator.hypotheses(&estimate, 3).unwrap();
    assert!(hypotheses.len() > 1);
    for hypothesis in hypotheses {
        for dof in [Dof::ThetaX, Dof::ThetaY, Dof::TX, Dof::TY, Dof::TZ] {
            assert_eq!(hypothesis.pose[dof], estimate.pose[dof], "{dof}");
            assert_eq!(hypothesis.std[dof.index()], estimate.std[dof.index()], "{dof}");
        }
    }
}

#[test]
fn whole_pictures_have_no_windows() {
    let (rig, hand) = (rig(), HandShape::adult());
    let mut workspace = Workspace::default();
    let estimator = training(Framing::Picture).run(&rig, &hand, &poses(), &NoProgress).unwrap();
    let masks: Vec<Mask> =
        rig.cameras.iter().map(|camera| mask(camera, &closing(0.5, 10.0))).collect();
    let pictures: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
    let estimate = estimator.estimate(&pictures, &mut workspace).unwrap();
    assert_eq!(estimate.observation.framing(), Framing::Picture);
}

/// The hand as it would be located without error.
fn located(camera: &Camera, wrist: DVec3, arm: DVec3) -> HandDetection {
    let [at, ahead] = [wrist, wrist + arm].map(|point| camera.project(point).unwrap());
    HandDetection {
        wrist: at.to_array(),
        direction: (ahead - at).normalize().to_array(),
        width: 20.0,
        length: 70.0,
        across: [-20.0, 20.0],
        area: 2000.0,
        behind: 0.0,
        arm: 30.0,
        cut_off: false,
        mahalanobis2: 5.0,
        ahead_log_odds: 0.0,
        profile: Default::default(),
        component: 0,
    }
}

proptest! {
    #![proptest_config(property::cases(40))]

    #[test]
    fn several_views_tell_the_global_pose(
        t in prop::array::uniform3(-50.0..50.0), lean in prop::array::uniform2(-0.5..0.5),
        theta_z in 0.0..1.57, views in prop::sample::select(vec![vec![0, 1], vec![1, 2], vec![0, 1, 2]]),
        sizes in prop::array::uniform3(0.5..4.0),
    ) {
        let rig = Rig { cameras: views.iter().map(|&v| rig().cameras[v].clone()).collect(), ..rig() };
        let mut pose = Pose::REST;
        [pose[Dof::TX], pose[Dof::TY], pose[Dof::TZ]] = t;
        [pose[Dof::ThetaX], pose[Dof::ThetaY]] = lean;
        pose[Dof::ThetaZ] = theta_z;
        let arm = pose.rotation().z_axis;
        // Pictures of any size, another for each camera.
        let pictured = |(camera, size): (&Camera, f64)| {
            let Intrinsics { width, height, .. } = camera.intrinsics;
            let [width, height] = [width, height].map(|side| (size * f64::from(side)) as u32);
            let camera = camera.with_intrinsics(camera.intrinsics.resized(width, height));
            Some(PicturedHand { hand: located(&camera, DVec3::from(t), arm), camera })
        };
        let hands: Vec<_> = rig.cameras.iter().zip(sizes).map(pictured).collect();
        let known = Pose { ..pose };
        let mut fingers = Pose::REST;
        fingers[Dof::ThetaZ] = theta_z;
        let start = initial_global(&rig, &HandShape::adult(), &fingers, &hands).unwrap();
        prop_assert!(start.miss < 1e-6);
        for dof in Dof::ALL {
            prop_assert!((start.pose[dof] - known[dof]).abs() < 1e-3, "{dof}: {:?}", start.pose[dof]);
        }
    }

    #[test]
    fn scale_and_shift_of_the_picture_make_no_difference(
        closed in 0.0..1.0, theta in 0.0..60.0, zoom in 2_u32..4, dx in 0_u32..60, dy in 0_u32..60,
    ) {
        let camera = wide();
        let pose = closing(closed, theta);
        let whole = mask(&camera, &pose);
        let (window, seen) = look(&camera, &whole);
        // Where the arm's other end looks as much like a hand, more pixels may tip the balance: what is
        // compared is the same thing.
        let wrist = DVec2::from_array(window.hand.wrist);
        // The same picture with more pixels, drawn anew: where a wrist is hard to tell it may be
        // found a little further on.
        let inside = camera.intrinsics;
        let finer = camera.with_intrinsics(inside.resized(zoom * 480, zoom * 360));
        let finer = look_near(&finer, &mask(&finer, &pose), wrist * f64::from(zoom));
        prop_assert!(seen.mask.iou(&finer.mask) > 0.7, "{}", seen.mask.iou(&finer.mask));
        // The same picture on a larger sensor: all pixels moved.
        let shifted = Intrinsics {
            width: 480 + dx, height: 360 + dy,
            cx: inside.cx + f64::from(dx), cy: inside.cy + f64::from(dy), ..inside
        };
        let shifted = camera.with_intrinsics(shifted);
        let moved = Mask::from_fn(480 + dx, 360 + dy, |x, y| match (x.checked_sub(dx), y.checked_sub(dy)) {
            (Some(x), Some(y)) => whole.is_hand(x, y),
            // The arm goes on to the border.
            (None, y) => whole.is_hand(0, y.unwrap_or(0)),
            _ => false,
        });
        let moved = look_near(&shifted, &moved, wrist + DVec2::new(dx.into(), dy.into()));
        prop_assert!(seen.mask.iou(&moved.mask) > 0.85, "{}", seen.mask.iou(&moved.mask));
    }
}
