//! Scores of made-up answers to a made-up take, whose right answers are known.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::anyhow;
use glam::{DAffine3, DVec3};
use phalanx_camera::{Camera, Intrinsics};
use phalanx_hand::{Digit, HandShape, JOINTS, Pose, PosedHand};
use phalanx_lab::real::angles::{self, FingerState};
use phalanx_lab::real::method::{Found, Outcome, Sequence};
use phalanx_lab::real::reference::Reference;
use phalanx_lab::real::row::{Row, States};
use phalanx_lab::real::score::{self, Scorer};
use phalanx_lab::real::take::{Input, Take, takes_in};
use phalanx_render::Renderer;
use tempfile::TempDir;

const FRAMES: usize = 4;

fn cameras() -> [Camera; 2] {
    let camera = |name, place| {
        let inside = Intrinsics::pinhole(160, 120, 150.0);
        Camera::look_at(name, inside, place, DVec3::new(0.0, 0.0, 60.0), DVec3::X).unwrap()
    };
    [camera("above", DVec3::new(0.0, 500.0, 60.0)), camera("aside", DVec3::new(0.0, 300.0, -340.0))]
}

/// Open in even frames, all fingers folded in odd ones; 10 mm further to the side in each.
fn pose(frame: usize) -> Pose {
    let mut pose = Pose::REST;
    pose[phalanx_hand::Dof::TX] = 10.0 * frame as f64;
    for finger in Digit::FINGERS.into_iter().filter(|_| frame % 2 == 1) {
        for (dof, degrees) in finger.dofs().into_iter().zip([0.0_f64, 60.0, 85.0, 50.0]) {
            pose[dof] = degrees.to_radians();
        }
    }
    pose
}

fn posed(frame: usize) -> PosedHand {
    HandShape::adult().pose(&pose(frame), &DAffine3::IDENTITY)
}

fn json(camera: &Camera) -> serde_json::Value {
    let (inside, outside) = (&camera.intrinsics, &camera.extrinsics);
    let rows = [0, 1, 2].map(|row| outside.rotation.row(row).to_array());
    serde_json::json!({
        "name": camera.name, "width": inside.width, "height": inside.height,
        "camera_matrix": [
            [inside.fx, 0.0, inside.cx - 0.5], [0.0, inside.fy, inside.cy - 0.5], [0.0, 0.0, 1.0]
        ],
        "distortion_coefficients": [], "rotation": rows,
        "translation": outside.translation.to_array(),
    })
}

/// Writes the take, in the layout that is read, into a folder.
fn write_take(folder: &Path) {
    let cameras = cameras();
    let write = |name: &str, text: String| std::fs::write(folder.join(name), text).unwrap();
    write("take.json", r#"{"unit_mm": 1, "side": "right"}"#.to_owned());
    let calibration = serde_json::json!({"cameras": cameras.each_ref().map(json)});
    write("calibration.json", calibration.to_string());
    for camera in &cameras {
        let masks = folder.join("masks").join(&camera.name);
        std::fs::create_dir_all(&masks).unwrap();
        let mut landmarks = "frame,joint,x_px,y_px\n".to_owned();
        for frame in 0..FRAMES {
            let posed = posed(frame);
            let mask = Renderer::new(camera).unwrap().silhouette(&posed.primitives).unwrap();
            mask.save(masks.join(format!("{frame:04}.png"))).unwrap();
            for (joint, place) in posed.joints.iter().enumerate() {
                let pixel = camera.project(*place).unwrap();
                writeln!(landmarks, "{frame},{joint},{},{}", pixel.x, pixel.y).unwrap();
            }
        }
        write(&format!("landmarks-{}.csv", camera.name), landmarks);
    }
    write_references(&write);
}

fn write_references(write: &impl Fn(&str, String)) {
    let mut joints = "frame,joint,x_mm,y_mm,z_mm\n".to_owned();
    let names: [String; angles::COUNT] = std::array::from_fn(angles::name);
    let columns = |of: &str| names.each_ref().map(|name| format!("{name}_{of}")).join(",");
    let mut bones = format!("frame,{},{}\n", columns("deg"), columns("disagreement_deg"));
    let mut states = "frame,thumb,index,middle,ring,little\n".to_owned();
    for frame in 0..FRAMES {
        let of = posed(frame).joints;
        for (joint, place) in of.iter().enumerate() {
            writeln!(joints, "{frame},{joint},{},{},{}", place.x, place.y, place.z).unwrap();
        }
        let angles = angles::of_joints(&of);
        let cells = angles.map(|angle| angle.to_string()).join(",");
        // The last angle is not agreed on.
        let apart = "1,".repeat(angles::COUNT - 1) + "99";
        writeln!(bones, "{frame},{cells},{apart}").unwrap();
        let name = |state: &FingerState| match state {
            FingerState::Extended => "extended",
            FingerState::Folded => "folded",
        };
        let cells: Vec<&str> = angles::states(&angles).iter().map(name).collect();
        // Nobody could tell the thumb's state.
        writeln!(states, "{frame:04},,{}", cells[1..].join(",")).unwrap();
    }
    write("reference-joints.csv", joints);
    write("reference-angles.csv", bones);
    write("finger-states.csv", states);
}

/// The row for answers to all frames.
fn row(answer: impl Fn(usize) -> anyhow::Result<Found>) -> Row {
    let data = TempDir::new().unwrap();
    let folder = data.path().join("made-up");
    std::fs::create_dir(&folder).unwrap();
    write_take(&folder);
    assert_eq!(takes_in(data.path()).unwrap(), std::slice::from_ref(&folder));
    let take = Take::read(&folder).unwrap();
    let reference = Reference::read(&folder, &take.camera_names()).unwrap();
    let frames = take.frames(&[0, 1], Input::Masks);
    assert_eq!(frames.len(), FRAMES);
    let sequence = Sequence {
        take: &take,
        views: &[0, 1],
        input: Input::Masks,
        frames: &frames,
        spoil: None,
        lose: None,
        landmarks: &reference.landmarks,
    };
    let outcome = |frame| Outcome { found: answer(frame), cpu_ms: Some(frame as f64) };
    let outcomes: Vec<Outcome> = (0..FRAMES).map(outcome).collect();
    let scores = Scorer::new(&reference).frames(&sequence, &outcomes).unwrap();
    score::row(&sequence, "made-up", &outcomes, &scores).unwrap()
}

fn right(frame: usize) -> Found {
    Found::posed(&HandShape::adult(), &pose(frame), &DAffine3::IDENTITY)
}

#[test]
fn right_answers_have_no_error() {
    let row = row(|frame| Ok(right(frame)));
    let joints = row.joints_mm.unwrap();
    assert!(joints.mean < 1e-9 && joints.p95 < 1e-9, "{joints:?}");
    assert_eq!(row.states, Some(States { right: 16, of: 16 }));
    assert!(row.bone_angles_deg.unwrap() < 1e-4, "{:?}", row.bone_angles_deg);
    assert!(row.best_constant_deg.unwrap() > 5.0, "{:?}", row.best_constant_deg);
    let iou = row.iou.unwrap();
    assert!(iou.mean > 0.99 && iou.least_above_088 == 1.0, "{iou:?}");
    assert!(row.reprojection.unwrap().p90 < 1e-9);
    assert_eq!((row.coverage, row.std_mm), (None, None));
    assert_eq!((row.frames, row.refused, row.doubted), (4, 0, 0));
    assert_eq!((row.ms.unwrap().median, row.ms.unwrap().p95), (2.0, 3.0));
}

#[test]
fn a_shifted_hand_is_off_by_its_shift() {
    let row = row(|frame| {
        let shift = DAffine3::from_translation(DVec3::new(0.0, 0.0, 12.0));
        let found = Found::posed(&HandShape::adult(), &pose(frame), &shift);
        let deviations = Some([DVec3::splat(10.0); JOINTS]);
        Ok(Found { deviations, doubts: vec!["made up".to_owned()], ..found })
    });
    let joints = row.joints_mm.unwrap();
    assert!([joints.mean, joints.median, joints.p95].iter().all(|mm| (mm - 12.0).abs() < 1e-9));
    assert!(row.bone_angles_deg.unwrap() < 1e-4);
    assert!(row.iou.unwrap().mean < 0.95);
    assert!(row.reprojection.unwrap().median > 0.02);
    // Two of three coordinates are right, and the third is 1.2 deviations off.
    let coverage = row.coverage.unwrap();
    let third = 2.0 / 3.0;
    assert!((coverage.half - third).abs() < 1e-9 && (coverage.one_sigma - third).abs() < 1e-9);
    assert_eq!(coverage.two_sigma, 1.0);
    assert!((row.std_mm.unwrap() - 10.0 * 3.0_f64.sqrt()).abs() < 1e-9);
    assert_eq!(row.doubted, 4);
}

#[test]
fn a_refused_frame_counts_as_the_best_constant() {
    let row = row(|frame| if frame < 2 { Err(anyhow!("no hand")) } else { Ok(right(frame)) });
    assert_eq!((row.refused, row.doubted), (2, 0));
    assert_eq!(row.states, Some(States { right: 8, of: 16 }));
    let iou = row.iou.unwrap();
    assert!((iou.mean - 0.5).abs() < 0.01 && iou.least_above_088 == 0.5, "{iou:?}");
    // Half of the hands are open and half are fists: the constant is as far from both.
    let joints = row.joints_mm.unwrap();
    let [open, fist] = [0, 1].map(|frame| {
        let joints = posed(frame).joints;
        joints.map(|joint| joint - joints[0])
    });
    let half: f64 = open.iter().zip(&fist).map(|(a, b)| a.distance(*b) / 2.0).sum();
    assert!((joints.mean - half / JOINTS as f64 / 2.0).abs() < 1e-9, "{joints:?}");
    assert!((row.bone_angles_deg.unwrap() - row.best_constant_deg.unwrap() / 2.0).abs() < 1e-4);
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let data = TempDir::new().unwrap();
    let folder = data.path().join("made-up");
    std::fs::create_dir(&folder).unwrap();
    write_take(&folder);
    let broken = |name: &str, text: &str| {
        let path = folder.join(name);
        let before = std::fs::read(&path).unwrap();
        std::fs::write(&path, text).unwrap();
        let take = Take::read(&folder);
        let error = match take {
            Err(error) => error,
            Ok(take) => Reference::read(&folder, &take.camera_names()).unwrap_err(),
        };
        std::fs::write(&path, before).unwrap();
        let message = format!("{error:#}");
        assert!(message.contains(name), "{message}");
        message
    };
    broken("calibration.json", "{}");
    broken("take.json", r#"{"unit_mm": "ten"}"#);
    broken("take.json", r#"{"unit_mm": 1, "side": "both"}"#);
    assert!(
        broken("reference-joints.csv", "frame,joint,x_mm,y_mm,z_mm\n0,21,1,1,1\n")
            .contains("line 2")
    );
    assert!(broken("landmarks-aside.csv", "frame,joint,x_px,y_px\n0,1,a,1\n").contains("'a'"));
    assert!(broken("reference-angles.csv", "frame,thumb\n").contains("thumb_CMC_deg"));
    assert!(
        broken("finger-states.csv", "frame,thumb,index,middle,ring,little\n0,bent,,,,\n")
            .contains("bent")
    );
    std::fs::write(folder.join("masks/above/0.png"), "twice").unwrap();
    assert!(format!("{:#}", Take::read(&folder).unwrap_err()).contains("the same frame"));
}
