//! `phalanx rig`: from other tools' calibrations to rig files, and back.

use phalanx_camera::{Lens, Rig};
use tempfile::TempDir;

use crate::desk::{CAMERAS, Desk, Outcome, run};

/// Two cameras half a metre from the hand, as Caliscope writes them, in metres; one is a fisheye.
const CALISCOPE: &str = "
[cameras.0]
cam_id = 0
fisheye = true
size = [1280, 720]
matrix = [[500.0, 0.0, 639.5], [0.0, 500.0, 359.5], [0.0, 0.0, 1.0]]
distortions = [-0.01, 0.002, 0.0, 0.0]
rotation = [0.0, 0.0, 0.0]
translation = [0.0, 0.0, 0.5]

[cameras.1]
cam_id = 1
fisheye = false
size = [1280, 720]
matrix = [[900.0, 0.0, 639.5], [0.0, 900.0, 359.5], [0.0, 0.0, 1.0]]
distortions = [-0.1, 0.02, 0.001, -0.002, 0.0]
rotation = [0.0, 1.0, 0.0]
translation = [0.0, 0.0, 0.6]
odd_key = 3
";

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        std::fs::write(folder.path().join("camera_array.toml"), CALISCOPE).unwrap();
        Self(folder)
    }

    fn run(&self, arguments: &str) -> Outcome {
        run(self.0.path(), ["rig"].into_iter().chain(arguments.split_whitespace()))
    }

    fn read(&self, name: &str) -> Option<String> {
        std::fs::read_to_string(self.0.path().join(name)).ok()
    }
}

#[test]
fn a_calibration_becomes_a_rig_and_says_what_to_look_at() {
    let folder = Folder::new();
    let outcome = folder.run("import camera_array.toml --unit m --out rig.toml");
    assert_eq!((outcome.code, outcome.out.as_str()), (Some(0), ""), "{}", outcome.err);
    for part in [
        "note: not known and passed over: odd_key",
        "cam_0 and cam_1: 535 mm apart",
        "cam_0: a hand of 190 mm is 190 px long in the picture, 500 mm away",
        "where the hand works was not given (--center, --forearm, --up) and is guessed",
    ] {
        assert!(outcome.err.contains(part), "no '{part}' in: {}", outcome.err);
    }
    let outcome = folder.run("import camera_array.toml --unit m --out rig.toml --json");
    let said: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!(said["views"][0]["distance_mm"].as_f64().unwrap().round(), 500.0, "{said}");
    let rig = Rig::from_toml(&folder.read("rig.toml").unwrap()).unwrap();
    assert!(matches!(rig.cameras[0].intrinsics.lens, Lens::Fisheye(_)));
    assert_eq!(rig.cameras[1].extrinsics.translation.z, 600.0);
    // A rig is a calibration too, which says its unit and its volume.
    let again = folder.run("import rig.toml --volume-size 80,90,100 --out again.toml");
    assert_eq!(again.code, Some(0), "{}", again.err);
    assert!(!again.err.contains("is guessed"), "{}", again.err);
    let again = Rig::from_toml(&folder.read("again.toml").unwrap()).unwrap();
    assert_eq!((again.volume.center, again.volume.size.y), (rig.volume.center, 90.0));
}

#[test]
fn exports_import_to_the_same_rig() {
    let folder = Folder::new();
    folder.run("import camera_array.toml --unit m --out rig.toml");
    for format in ["anipose", "opencv"] {
        let outcome = folder.run(&format!("export rig.toml --format {format} --out exported"));
        assert_eq!((outcome.code, outcome.out.as_str()), (Some(0), ""), "{}", outcome.err);
        let printed = folder.run(&format!("export rig.toml --format {format}"));
        assert_eq!(Some(printed.out), folder.read("exported"));
        let outcome = folder.run("import exported --out again.toml");
        assert_eq!(outcome.code, Some(0), "{}", outcome.err);
        let rig = |name| Rig::from_toml(&folder.read(name).unwrap()).unwrap();
        for (camera, again) in rig("rig.toml").cameras.iter().zip(&rig("again.toml").cameras) {
            assert_eq!((&camera.name, camera.intrinsics), (&again.name, again.intrinsics));
            assert!(camera.centre().distance(again.centre()) < 1e-9, "{format}");
        }
    }
}

#[test]
fn a_check_prints_sizes_and_angles() {
    let folder = Folder::new();
    folder.run("import camera_array.toml --unit m --out rig.toml");
    let outcome = folder.run("check rig.toml");
    assert_eq!((outcome.code, outcome.err.as_str()), (Some(0), ""));
    assert!(outcome.out.contains("cam_0 and cam_1 look from 57° apart"), "{}", outcome.out);
    let outcome = folder.run("check rig.toml --json");
    let report: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!(report["views"][1]["camera"], "cam_1");
    assert!((report["views"][1]["px_per_mm"].as_f64().unwrap() - 1.5).abs() < 0.01, "{report}");
    assert!((report["pairs"][0]["angle_deg"].as_f64().unwrap() - 57.3).abs() < 0.1, "{report}");
    // From nearly the same side.
    let near =
        folder.read("camera_array.toml").unwrap().replace("[0.0, 1.0, 0.0]", "[0.0, 0.1, 0.0]");
    std::fs::write(folder.0.path().join("near.toml"), near).unwrap();
    folder.run(
        "import near.toml --unit m --center 0,0,0 --forearm 0,1,0 --up 0,0,-1 --out near-rig.toml",
    );
    let outcome = folder.run("check near-rig.toml");
    assert!(
        outcome.err.contains("doubt: cam_0 and cam_1 look from nearly the same side (6°)"),
        "{}",
        outcome.err
    );
}

/// The hand is looked for in a recording, wherever the rig has its volume.
#[test]
fn a_check_of_a_recording_says_sizes_where_the_hand_is() {
    let desk = Desk::new();
    desk.write_rig("rig.toml");
    let mut rig = Rig::from_toml(&String::from_utf8(desk.read("rig.toml")).unwrap()).unwrap();
    let sight = (rig.volume.center - rig.cameras[0].centre()).normalize();
    rig.volume.center += 60.0 * sight;
    desk.write("far.toml", rig.to_toml().unwrap().as_bytes());
    for (frame, closed) in [0.0, 0.5, 0.9].into_iter().enumerate() {
        desk.draw_frame("take", &format!("{frame}.png"), closed);
        desk.draw_frame("empty", &format!("{frame}.png"), closed);
    }
    let distances = |arguments: &[&str]| {
        let outcome = run(desk.folder(), ["rig", "check", "--json"].iter().chain(arguments));
        assert_eq!((outcome.code, outcome.err.as_str()), (Some(0), ""));
        let report: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
        [0, 1].map(|view| report["views"][view]["distance_mm"].as_f64().unwrap())
    };
    let right = distances(&["rig.toml"]);
    let off = |found: [f64; 2]| (found[0] - right[0]).abs().max((found[1] - right[1]).abs());
    assert!(off(distances(&["far.toml"])) > 40.0);
    let seen = off(distances(&["far.toml", "take", "--mask"]));
    assert!(seen < 20.0, "{seen} mm");

    for frame in 0..3 {
        for camera in CAMERAS {
            let black = image::GrayImage::new(120, 90);
            desk.save(&format!("empty/{camera}/{frame}.png"), &black.into());
        }
    }
    let outcome = run(desk.folder(), ["rig", "check", "far.toml", "empty", "--mask"]);
    assert_eq!((outcome.code, outcome.out.as_str()), (Some(2), ""), "{}", outcome.err);
}

#[test]
fn what_cannot_be_is_refused_and_nothing_is_written() {
    let folder = Folder::new();
    let write = |name: &str, text: &str| std::fs::write(folder.0.path().join(name), text).unwrap();
    write("omni.toml", &CALISCOPE.replacen("fisheye = true", "model = \"omni\"", 1));
    write("half.toml", &CALISCOPE.replace("rotation = [0.0, 1.0, 0.0]\n", ""));
    write("unsized.toml", &CALISCOPE.replacen("size = [1280, 720]\n", "", 1));
    let volume = "--center 0,0,0 --forearm 0,1,0 --up 0,0,-1";
    for (arguments, part) in [
        ("camera_array.toml", "(Caliscope writes metres): give the unit"),
        ("camera_array.toml --unit mm", "apart, where 20 mm to 20 m are believed"),
        ("camera_array.toml --unit yard", "`yard` is no unit"),
        ("camera_array.toml --unit m --square-mm 3", "cannot be used with"),
        ("camera_array.toml --unit m --size 640", "expected WIDTHxHEIGHT"),
        ("camera_array.toml --unit m --size 640x480", "size is 1280×720 px in the file"),
        ("omni.toml --unit m", "omni.toml: camera `cam_0`: model `omni`"),
        ("half.toml --unit m", "half.toml: camera `cam_1`: rotation is missing"),
        (
            "unsized.toml --unit m",
            "give the pictures' size, such as --size 1280x720: unsized.toml:",
        ),
        ("none.toml --unit m", "none.toml: No such file"),
        ("", "required arguments"),
    ] {
        let outcome = folder.run(&format!("import {arguments} --out rig.toml"));
        assert_eq!((outcome.code, folder.read("rig.toml")), (Some(2), None), "{arguments}");
        assert!(outcome.err.contains(part), "no '{part}' in: {}", outcome.err);
    }
    // A hand a finger's width from the lens.
    write("one.toml", CALISCOPE.split("[cameras.1]").next().unwrap());
    let near = volume.replacen("0,0,0", "0,0,-490", 1);
    let outcome = folder.run(&format!("import one.toml --unit m {near} --out rig.toml"));
    assert_eq!((outcome.code, folder.read("rig.toml")), (Some(2), None));
    assert!(outcome.err.contains("a hand of 190 mm would be 9500 px long"), "{}", outcome.err);
}

#[test]
fn a_wrong_unit_is_told_from_a_bad_lens() {
    let folder = Folder::new();
    // Turns back 30° off its axis, where the hand is only if the cameras are near.
    let folding =
        CALISCOPE.replace("[-0.1, 0.02, 0.001, -0.002, 0.0]", "[-0.014, 1.42, 0.0, 0.0, -6.39]");
    std::fs::write(folder.0.path().join("folding.toml"), folding).unwrap();
    for (arguments, advice) in [
        ("folding.toml --unit 150", Some("; a length of 1 is hardly 150 mm: the cameras see")),
        ("folding.toml --unit mm", Some("if a length of 1 is 220 to 3800 mm, such as --unit m\n")),
        ("folding.toml", Some("; the cameras see a hand well if a length of 1 is 220")),
        // The unit is right, and the hand works too near.
        ("folding.toml --unit m --volume-size 900,900,900", None),
    ] {
        let outcome = folder.run(&format!("import {arguments} --out rig.toml"));
        assert_eq!((outcome.code, folder.read("rig.toml")), (Some(2), None), "{arguments}");
        let lens = "phalanx: folding.toml: camera `cam_1`: its distortion folds over";
        let said = advice.unwrap_or(lens);
        assert!(outcome.err.contains(said), "no '{said}' in: {}", outcome.err);
    }
    assert_eq!(folder.run("import folding.toml --unit m --out rig.toml").code, Some(0));
}

#[test]
fn what_is_no_rig_is_named_without_its_text() {
    let folder = Folder::new();
    let row = "0.25,".repeat(300);
    std::fs::write(folder.0.path().join("take.csv"), format!("frame,time\n{row}\n")).unwrap();
    std::fs::write(folder.0.path().join("picture.png"), [0x89, b'P', 0xff, 0xfe]).unwrap();
    for name in ["take.csv", "picture.png", "camera_array.toml"] {
        let outcome = folder.run(&format!("check {name}"));
        let said = format!("{name}: no rig; `phalanx rig import` makes one of a calibration: ");
        assert!(outcome.code == Some(2) && outcome.err.contains(&said), "{}", outcome.err);
        assert!(outcome.err.lines().count() == 1 && outcome.err.len() < 300, "{}", outcome.err);
    }
    let arguments = ["train", "--preset", "fast", "--hand", "take.csv", "--out", "model"];
    let outcome = run(folder.0.path(), arguments);
    assert!(outcome.err.contains("take.csv: hand: line 1: "), "{}", outcome.err);
    assert_eq!(outcome.err.lines().count(), 1, "{}", outcome.err);
}
