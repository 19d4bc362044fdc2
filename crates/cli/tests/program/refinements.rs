//! Refined estimates and calibrated hands.

use phalanx_hand::{Dof, HandShape};
use serde_json::Value;

use crate::desk::{CAMERAS, Desk, closing, run};

const MASKS: [&str; 4] = ["--json", "--mask", "side-mask.png", "top-mask.png"];

/// Mean error of the fingers' angles in a report, degrees.
fn error_deg(json: &str) -> f64 {
    let report: Value = serde_json::from_str(json).unwrap();
    let truth = closing(0.5);
    let off = Dof::ALL[4..20].iter().map(|&dof| {
        let value = report["pose"][dof.name()]["value"].as_f64().unwrap();
        (value - truth[dof].to_degrees()).abs()
    });
    off.sum::<f64>() / 16.0
}

#[test]
fn a_refined_estimate_is_as_good_or_better() {
    let desk = Desk::new();
    let plain = desk.estimate(&MASKS);
    let refined = desk.estimate(&[&["--refine"], &MASKS[..]].concat());
    assert_eq!(refined.code, Some(0), "{}", refined.err);
    let (plain, refined) = (error_deg(&plain.out), error_deg(&refined.out));
    assert!(refined < plain + 0.5 && refined < 3.0, "{refined} after {plain}");
}

#[test]
fn a_hand_is_calibrated_and_used() {
    let desk = Desk::new();
    for frame in 0..4 {
        desk.draw_frame("frames", &format!("{frame}.png"), 0.2 * f64::from(frame));
    }
    let calibrate = ["calibrate-hand", "--model", "model", "--frames", "frames", "--mask"];
    let out = ["--out", "me.toml"];
    let done = run(desk.folder(), calibrate.iter().chain(&out));
    assert_eq!(done.code, Some(0), "{}", done.err);
    assert!(done.out.starts_with("me.toml: from 4 frames"), "{}", done.out);
    let hand = String::from_utf8(desk.read("me.toml")).unwrap();
    let hand = HandShape::from_toml(&hand).unwrap();
    let (own, given) = (hand.middle.base_mm.z, HandShape::adult().middle.base_mm.z);
    assert!((own / given - 1.0).abs() < 0.05, "{own} mm");
    let done = run(desk.folder(), calibrate.iter().chain(&["--out", "again.toml", "--json"]));
    let said: serde_json::Value = serde_json::from_str(&done.out).unwrap();
    assert!(said.is_object() && desk.read("again.toml") == desk.read("me.toml"), "{said}");
    let with_it = ["--refine", "--hand", "me.toml"];
    let refined = desk.estimate(&[&with_it, &MASKS[..]].concat());
    assert_eq!(refined.code, Some(0), "{}", refined.err);
}

#[test]
fn too_few_frames_are_refused_and_nothing_is_written() {
    let desk = Desk::new();
    desk.draw_frame("frames", "0.png", 0.3);
    // A frame that one camera lacks.
    desk.draw_frame("frames", "1.png", 0.6);
    std::fs::remove_file(desk.path("frames").join(CAMERAS[1]).join("1.png")).unwrap();
    let arguments = ["calibrate-hand", "--model", "model", "--frames", "frames", "--mask"];
    let refused = run(desk.folder(), arguments.iter().chain(&["--out", "me.toml"]));
    assert_eq!(refused.code, Some(2));
    assert!(refused.err.contains("frame 1.png is left out"), "{}", refused.err);
    assert!(refused.err.contains("1 frame can be used; at least 3"), "{}", refused.err);
    assert!(!desk.path("me.toml").exists());
}

#[test]
fn copies_of_one_frame_are_refused_and_nothing_is_written() {
    let desk = Desk::new();
    for frame in 0..12 {
        desk.draw_frame("frames", &format!("{frame}.png"), 0.3);
    }
    let arguments = ["calibrate-hand", "--model", "model", "--frames", "frames", "--mask"];
    let refused = run(desk.folder(), arguments.iter().chain(&["--out", "me.toml"]));
    assert_eq!(refused.code, Some(2));
    let reason = "the 12 frames show 1 different posture; at least 3";
    assert!(refused.err.contains(reason), "{}", refused.err);
    assert!(!desk.path("me.toml").exists());
}

#[test]
fn a_hand_before_exchanged_cameras_is_refused_by_name() {
    let desk = Desk::new();
    desk.learn_doubts();
    for frame in 0..6 {
        desk.draw_frame("frames", &format!("{frame}.png"), 0.18 * f64::from(frame));
    }
    let [side, top] = CAMERAS.map(|camera| desk.path("frames").join(camera));
    std::fs::rename(&side, desk.path("other")).unwrap();
    std::fs::rename(&top, &side).unwrap();
    std::fs::rename(desk.path("other"), &top).unwrap();
    let arguments = ["calibrate-hand", "--model", "model", "--frames", "frames", "--mask"];
    let refused = run(desk.folder(), arguments.iter().chain(&["--out", "me.toml"]));
    assert_eq!(refused.code, Some(2), "{}", refused.err);
    let reason = "frames are doubted: camera 'side': it shows what camera 'top' should see";
    assert!(refused.err.contains(reason), "{}", refused.err);
    assert!(!desk.path("me.toml").exists());
}
