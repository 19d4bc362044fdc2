//! `phalanx doctor` and `phalanx rig check --simulate`.

use std::process::Command;

use phalanx::draw_silhouette;
use phalanx_camera::{Intrinsics, Rig};
use phalanx_hand::{HandShape, Side};
use serde_json::Value;

use crate::desk::{DEMO, Desk, Outcome, closing, run};

fn doctor(desk: &Desk, arguments: &[&str]) -> (Option<i32>, Value) {
    let outcome = run(desk.folder(), ["doctor", "--json"].iter().chain(arguments));
    assert!(!outcome.out.is_empty(), "{}", outcome.err);
    (outcome.code, serde_json::from_str(&outcome.out).unwrap())
}

/// The findings in a state, each as what it is of and what it says.
fn in_state(report: &Value, state: &str) -> Vec<String> {
    let findings = report["findings"].as_array().unwrap().iter();
    let found = findings.filter(|finding| finding["state"] == state);
    found.map(|finding| format!("{}: {}", finding["what"], finding["text"])).collect()
}

/// A desk with eight frames of a moving hand before both cameras.
fn recorded() -> Desk {
    let desk = Desk::new();
    desk.write_rig("rig.toml");
    for frame in 0..8 {
        desk.draw_frame(
            "take",
            &format!("{frame}.png"),
            0.5 - 0.5 * (0.9 * f64::from(frame)).cos(),
        );
    }
    desk
}

#[test]
fn nothing_given_says_what_is_there_and_where_to_begin() {
    let desk = Desk::new();
    let outcome = run(desk.folder(), ["doctor"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    assert!(outcome.out.starts_with("good    program  phalanx 0."), "{}", outcome.out);
    assert!(outcome.out.contains("\nnext: phalanx rig import "), "{}", outcome.out);
    let mut without_path = Command::new(env!("CARGO_BIN_EXE_phalanx"));
    let outcome: Outcome = without_path.arg("doctor").env("PATH", "").output().unwrap().into();
    assert!(outcome.out.contains("doubt   ffmpeg   it is not on the path"), "{}", outcome.out);
}

#[test]
fn what_fits_together_is_good_and_leads_on() {
    let desk = recorded();
    let (code, report) =
        doctor(&desk, &["--rig", "rig.toml", "--model", "model", "take", "--mask"]);
    assert_eq!(code, Some(0), "{report:#}");
    assert_eq!(report["next"], "phalanx track --rig rig.toml take --mask --out take.csv");
    let good = in_state(&report, "good").join("\n");
    for part in [
        "8 moments by 2 cameras; all are looked at",
        "the same in the rig and the model",
        "overlaps what it sees",
    ] {
        assert!(good.contains(part), "no '{part}' in {good}");
    }
}

#[test]
fn what_does_not_fit_is_broken_by_name() {
    let desk = recorded();
    let rig = String::from_utf8(desk.read("rig.toml")).unwrap();
    let mut moved = Rig::from_toml(&rig).unwrap();
    moved.cameras[1].extrinsics.translation.x += 40.0;
    desk.write("moved.toml", moved.to_toml().unwrap().as_bytes());
    let (code, report) = doctor(&desk, &["--rig", "moved.toml", "--model", "model"]);
    assert_eq!(code, Some(2));
    let broken = in_state(&report, "broken");
    assert!(broken.len() == 1 && broken[0].contains("camera 'top'"), "{broken:?}");
    assert!(broken[0].contains("(40.0 mm apart); train again"), "{broken:?}");
    assert!(report["next"].as_str().unwrap().contains("first camera 'top'"), "{report:#}");

    let mut renamed = Rig::from_toml(&rig).unwrap();
    renamed.cameras[0].name = "left".to_owned();
    desk.write("renamed.toml", renamed.to_toml().unwrap().as_bytes());
    desk.save("take/top/3.png", &image::GrayImage::new(40, 90).into());
    let arguments = ["--rig", "renamed.toml", "--model", "model", "take", "--mask"];
    let (code, report) = doctor(&desk, &arguments);
    assert_eq!(code, Some(2));
    let broken = in_state(&report, "broken").join("\n");
    assert!(broken.contains("the model knows it, the rig does not"), "{broken}");
    assert!(broken.contains("is it turned or cropped"), "{broken}");

    let (code, report) = doctor(&desk, &["--rig", "nowhere.toml", "--model", "rig.toml"]);
    assert_eq!((code, in_state(&report, "broken").len()), (Some(2), 2), "{report:#}");
}

/// What `track` doubts of a view, here fingers beyond the border, is doubted before.
#[test]
fn a_view_that_would_be_doubted_is_doubted() {
    let desk = Desk::new();
    desk.write_rig("rig.toml");
    let mut rig = Rig::from_toml(&String::from_utf8(desk.read("rig.toml")).unwrap()).unwrap();
    let joints = Desk::points(0.0)[1].map(glam::DVec2::from_array);
    let reach = |joint: &glam::DVec2| (*joint - joints[0]).length();
    let tip = joints.into_iter().max_by(|a, b| reach(a).total_cmp(&reach(b))).unwrap();
    let along = (tip - joints[0]).normalize();
    let room = |at: f64, along: f64, end: f64| (if along > 0.0 { end - at } else { -at }) / along;
    let beyond = room(tip.x, along.x, 120.0).min(room(tip.y, along.y, 90.0)) + 20.0;
    let shift = beyond * along;
    let own = rig.cameras[1].intrinsics;
    let moved = Intrinsics { cx: own.cx + shift.x, cy: own.cy + shift.y, ..own };
    rig.cameras[1] = rig.cameras[1].with_intrinsics(moved);
    desk.write("cut.toml", rig.to_toml().unwrap().as_bytes());
    let (hand, rest) = (HandShape::adult(), rig.volume.rest_frame());
    for frame in 0..8 {
        // Open, since a fist would be within the border.
        let closed = 0.03 * f64::from(frame);
        desk.draw_frame("take", &format!("{frame}.png"), closed);
        let pose = closing(closed);
        let mask = draw_silhouette(&rig.cameras[1], &hand, &pose, &rest).unwrap();
        desk.save(&format!("take/{}/{frame}.png", rig.cameras[1].name), &mask.into());
    }
    let (code, report) = doctor(&desk, &["--rig", "cut.toml", "take", "--mask"]);
    assert_eq!(code, Some(0), "{report:#}");
    let doubts = in_state(&report, "doubt").join("\n");
    assert!(
        doubts.contains("camera 'top'") && doubts.contains("the picture's border cuts it off: "),
        "{report:#}"
    );
    // They were given as masks already.
    assert!(doubts.contains("look at the masks") && !doubts.contains("give masks"), "{report:#}");
}

/// A camera of three that stands elsewhere than the calibration says is told from the two others.
#[test]
fn a_camera_that_contradicts_the_others_is_named() {
    let desk = Desk::new();
    let demo = DEMO.0.join("demo");
    let rig = std::fs::read_to_string(demo.join("rig.toml")).unwrap();
    let mut moved = Rig::from_toml(&rig).unwrap();
    let turn = glam::DMat3::from_rotation_y(0.12);
    let camera = &mut moved.cameras[1].extrinsics;
    (camera.rotation, camera.translation) = (turn * camera.rotation, turn * camera.translation);
    desk.write("moved.toml", moved.to_toml().unwrap().as_bytes());
    let recording = demo.join("recording");
    let arguments = ["--rig", "moved.toml", recording.to_str().unwrap(), "--mask"];
    let (code, report) = doctor(&desk, &arguments);
    assert_eq!(code, Some(2), "{report:#}");
    let good = in_state(&report, "good").join("\n");
    assert!(good.contains("60 moments by 3 cameras; 12 of them, drawn from all, are"), "{good}");
    let broken = in_state(&report, "broken");
    assert_eq!(broken.len(), 1, "{broken:?}");
    assert!(broken[0].contains(&moved.cameras[1].name) && broken[0].contains("it contradicts"));

    // Two cameras that stand for each other: where the hand works is not to be had from them.
    let mut exchanged = Rig::from_toml(&rig).unwrap();
    let [one, other] = [0, 2].map(|camera| exchanged.cameras[camera].name.clone());
    (exchanged.cameras[0].name, exchanged.cameras[2].name) = (other, one);
    desk.write("exchanged.toml", exchanged.to_toml().unwrap().as_bytes());
    desk.copy_eight_moments();
    let outcome = run(desk.folder(), ["rig", "check", "exchanged.toml", "eight", "--mask"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    assert!(outcome.err.contains("doubt: recording: the cameras"), "{}", outcome.err);
}

#[test]
fn a_left_hand_is_told_and_leads_on() {
    let desk = Desk::new();
    let rig = std::fs::read_to_string(DEMO.0.join("demo/rig.toml")).unwrap();
    desk.write("rig.toml", rig.as_bytes());
    let rig = Rig::from_toml(&rig).unwrap();
    let hand = HandShape { side: Side::Left, ..HandShape::adult() };
    for frame in 0..6 {
        let name = format!("{frame}.png");
        desk.draw_hand(&rig, &hand, ("take", &name), &closing(0.15 * f64::from(frame)));
    }
    let (code, report) = doctor(&desk, &["--rig", "rig.toml", "take", "--mask"]);
    assert_eq!(code, Some(0), "{report:#}");
    assert!(in_state(&report, "good").join("\n").contains("left hand"), "{report:#}");
    assert_eq!(
        report["next"],
        "phalanx track --rig rig.toml take --mask --side left --out take.csv"
    );
}

#[test]
fn a_simulation_says_what_to_expect_of_a_rig() {
    let desk = Desk::new();
    desk.write_rig("rig.toml");
    let outcome = run(desk.folder(), ["rig", "check", "rig.toml", "--simulate", "--json"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    let report: Value = serde_json::from_str(&outcome.out).unwrap();
    let angles = report["simulation"]["angles"].as_array().unwrap();
    assert_eq!(angles.len(), 22);
    for angle in angles {
        let [std, error] = ["std_deg", "error_deg"].map(|name| angle[name].as_f64().unwrap());
        assert!(std > 0.0 && std < 90.0 && error < 45.0, "{angle}");
    }
    // Of errors that keep to deviations the mean is four fifths of a deviation.
    let mean =
        |name: &str| angles.iter().map(|angle| angle[name].as_f64().unwrap()).sum::<f64>() / 22.0;
    let ratio = mean("error_deg") / mean("std_deg");
    assert!((0.4..1.4).contains(&ratio), "errors are {ratio:.2} deviations");
}

/// A rig is simulated with its whole pictures, of whatever shape.
#[test]
fn a_simulation_sees_what_wide_cameras_see() {
    let folder = tempfile::tempdir().unwrap();
    let mut rig = Rig::from_toml(include_str!("../../fixtures/desk.toml")).unwrap();
    for camera in &mut rig.cameras {
        let own = camera.intrinsics;
        let wider = Intrinsics { width: 160, cx: own.cx + 20.0, ..own };
        *camera = camera.with_intrinsics(wider);
    }
    std::fs::write(folder.path().join("rig.toml"), rig.to_toml().unwrap()).unwrap();
    let outcome = run(folder.path(), ["rig", "check", "rig.toml", "--simulate", "--json"]);
    let report: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
    let simulation = &report["simulation"];
    assert!(simulation["trusted"].as_u64().unwrap() > 24, "{simulation}");
    assert!(simulation["joints_mm"].as_f64().unwrap() < 15.0, "{simulation}");
}
