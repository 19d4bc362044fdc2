//! `phalanx track --landmarks` on drawn recordings.

use std::fmt::Write;

use phalanx_io::take::{LeftOut, TakeFrame};
use serde_json::json;

use crate::desk::{CAMERAS, Desk, Outcome, run};
use crate::tracks::{closed, error_mm, recorded, take};

const FRAMES: usize = 8;

fn track(desk: &Desk, arguments: &[&str]) -> Outcome {
    run(desk.folder(), ["track", "--rig", "rig.toml"].iter().chain(arguments))
}

/// The points of a camera in frames of these numbers, off by a third of a pixel or less.
fn table(camera: usize, frames: impl Iterator<Item = usize>) -> String {
    let mut text = "frame,joint,x_px,y_px\n".to_owned();
    for frame in frames {
        for (joint, [x, y]) in Desk::points(closed(frame))[camera].into_iter().enumerate() {
            let off = 0.3 * (2.4 * (21 * frame + joint) as f64).sin();
            writeln!(text, "{frame:04},{joint},{},{}", x + off, y - off).unwrap();
        }
    }
    text
}

#[test]
fn landmarks_without_a_recording_become_angles() {
    let desk = recorded(0);
    for (camera, name) in CAMERAS.into_iter().enumerate() {
        desk.write(&format!("{name}.csv"), table(camera, 0..FRAMES).as_bytes());
    }
    let [one, other] = CAMERAS.map(|camera| format!("{camera}={camera}.csv"));
    let given = ["--landmarks", &other, "--landmarks", &one, "--out", "points.csv"];
    let outcome = track(&desk, &given);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let points = take(&desk, "points.csv");
    assert_eq!(points.frames.len(), FRAMES);
    assert!(points.frames.iter().all(|frame| frame.views.iter().all(|view| view.used)));
    assert!(error_mm(&points) < 5.0, "{} mm", error_mm(&points));

    // In one file by the cameras' names, in shares of the pictures.
    let [width, height] = [120.0, 90.0];
    let frames = |camera: usize| -> Vec<serde_json::Value> {
        let of = |frame: usize| {
            Desk::points(closed(frame))[camera].map(|[x, y]| json!([x / width, y / height]))
        };
        (0..FRAMES).map(|frame| json!(of(frame))).collect()
    };
    let all = json!({ "views": { CAMERAS[0]: frames(0), CAMERAS[1]: frames(1) } });
    desk.write("all.json", all.to_string().as_bytes());
    let outcome = track(&desk, &["--landmarks", "all.json", "--out", "all.csv"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert!(error_mm(&take(&desk, "all.csv")) < 5.0);
}

#[test]
fn landmarks_join_a_recording() {
    let desk = recorded(FRAMES);
    // A file a frame, as OpenPose writes them, of one camera; the other has masks alone.
    std::fs::create_dir(desk.path("openpose")).unwrap();
    for frame in 0..FRAMES {
        let points = Desk::points(closed(frame))[0].into_iter();
        let numbers: Vec<f64> = points.flat_map(|[x, y]| [x, y, 0.8]).collect();
        let people = json!([{ "hand_right_keypoints_2d": numbers, "hand_left_keypoints_2d": [] }]);
        let name = format!("openpose/side_{frame:012}_keypoints.json");
        desk.write(&name, json!({ "people": people }).to_string().as_bytes());
    }
    let given = format!("{}=openpose", CAMERAS[0]);
    let outcome = track(&desk, &["take", "--mask", "--landmarks", &given, "--out", "both.csv"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let both = take(&desk, "both.csv");
    assert!(both.frames.iter().all(|frame| frame.views.iter().all(|view| view.overlap.is_some())));
    assert!(error_mm(&both) < 8.0, "{} mm", error_mm(&both));

    // Landmarks alone of a camera beside another's masks.
    let [masks, points] =
        [format!("{0}=take/{0}", CAMERAS[1]), format!("{}=points.csv", CAMERAS[0])];
    desk.write("points.csv", table(0, (0..FRAMES).step_by(2)).as_bytes());
    let outcome = track(&desk, &[&masks, "--mask", "--landmarks", &points, "--out", "mixed.csv"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let mixed = take(&desk, "mixed.csv");
    let used = |number: usize| mixed.frames[number].views.iter().filter(|view| view.used).count();
    assert_eq!((mixed.frames.len(), used(2), used(3)), (FRAMES, 2, 1));
}

#[test]
fn landmarks_that_contradict_the_masks_are_named() {
    let desk = recorded(4);
    let shifted = |row: &str| {
        let mut cells = row.split(',').map(str::to_owned).collect::<Vec<_>>();
        if let Ok(x) = cells[2].parse::<f64>() {
            cells[2] = (x + 25.0).to_string();
        }
        cells.join(",") + "\n"
    };
    let far: String = table(0, 0..4).lines().map(shifted).collect();
    desk.write("far.csv", far.as_bytes());
    let given = format!("{}=far.csv", CAMERAS[0]);
    let outcome = track(&desk, &["take", "--mask", "--landmarks", &given, "--out", "take.csv"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let found = take(&desk, "take.csv");
    let named = |frame: &&TakeFrame| frame.views[0].left_out == Some(LeftOut::Landmarks);
    assert_eq!(found.frames.iter().filter(named).count(), 4, "{outcome:?}");
    assert!(error_mm(&found) < 9.0, "{} mm", error_mm(&found));
}

#[test]
fn landmarks_of_something_else_are_refused_by_name() {
    let desk = recorded(2);
    desk.write("late.csv", table(0, 70..72).as_bytes());
    desk.write("bad.csv", b"frame,joint,x_px,y_px\n0,0,here,1\n");
    let list = json!([Desk::points(0.0)[0], Desk::points(0.0)[0], Desk::points(0.0)[0]]);
    desk.write("three.json", list.to_string().as_bytes());
    let of_first = |path: &str| format!("{}={path}", CAMERAS[0]);
    for (given, words) in [
        (of_first("late.csv"), "landmarks of frame 70"),
        (of_first("bad.csv"), "line 2, column 'x_px': 'here' is no number"),
        (of_first("three.json"), "landmarks of 3 frames, but 2 frames"),
        (of_first("nowhere.csv"), "nowhere.csv"),
        ("three.json".to_owned(), "name the camera, such as side=three.json"),
        (of_first("take"), "no .json file"),
    ] {
        let outcome = track(&desk, &["take", "--mask", "--landmarks", &given, "--out", "t.csv"]);
        assert_eq!(outcome.code, Some(2), "{outcome:?}");
        assert!(outcome.err.contains(words), "{outcome:?}");
        assert!(!desk.path("t.csv").exists());
    }
}
