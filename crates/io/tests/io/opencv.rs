//! Cameras against OpenCV's own: files that its `FileStorage` writes are read, what we write it reads,
//! and both project alike, with every lens.
//!
//! Installs `opencv-python-headless` from PyPI into a virtual environment under the target folder:
//! `cargo test --workspace --test io -- --ignored opencv`.

use std::path::Path;
use std::process::Command;

use glam::{DVec2, DVec3};
use phalanx_camera::Camera;
use phalanx_io::calibration::{
    Calibration, Missing, Source, Unit, to_anipose_toml, to_opencv_yaml,
};

use crate::installed::{self, run};

/// How far two projections may be apart, px.
const TOLERANCE: f64 = 1e-6;

/// Of OpenCV's releases, the one that is compared with.
const OPENCV: &str = "opencv-python-headless==5.0.0.93";

const LENSES: [&str; 5] = ["brown", "rational", "prism", "tilted", "fisheye"];

fn script(python: &Path, mode: &str, path: &Path) -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/io/opencv.py");
    run(Command::new(python).arg(script).arg(mode).arg(path))
}

fn read(path: &Path) -> Vec<Camera> {
    let bytes = std::fs::read(path).expect("a file");
    let file = Source { name: "calibration", bytes: &bytes };
    let missing = Missing { unit: Some(Unit::MILLIMETRE), size: None };
    let calibration = Calibration::read(&[file], &missing);
    calibration.unwrap_or_else(|error| panic!("{}: {error}", path.display())).cameras
}

/// Asserts that cameras see what lines of `camera x y z u v` say, and that none is left out.
fn assert_projections(cameras: &[Camera], lines: &str, what: &str) {
    assert_eq!(lines.lines().count(), 40 * cameras.len(), "{what}");
    for line in lines.lines() {
        let mut words = line.split_whitespace();
        let name = words.next().expect("a name");
        let numbers: Vec<f64> = words.map(|word| word.parse().expect("a number")).collect();
        let [x, y, z, u, v] = numbers[..] else { panic!("{line}") };
        let camera = cameras.iter().find(|camera| camera.name == name).expect("by name");
        let seen = camera.project(DVec3::new(x, y, z)).expect("in front of the camera");
        // OpenCV counts from the first pixel's centre.
        let off = (seen - DVec2::new(u + 0.5, v + 0.5)).length();
        assert!(off < TOLERANCE, "{what}: camera {name} is {off:e} px off");
        let ray = camera.unproject(seen).expect("short of the fold");
        let missed = ray.direction.cross(DVec3::new(x, y, z) - ray.origin).length();
        assert!(missed < TOLERANCE, "{what}: camera {name} looks {missed:e} mm past");
    }
}

#[test]
#[ignore = "installs opencv-python-headless from PyPI"]
fn opencv_and_we_see_alike_by_each_others_files() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("opencv");
    let Some(python) = installed::python(&folder, &[OPENCV]) else { return };
    let folder = folder.join("files");
    std::fs::create_dir_all(&folder).expect("a folder");
    script(&python, "make", &folder);
    for lens in LENSES {
        let expected = std::fs::read_to_string(folder.join(lens).with_extension("txt"));
        let expected = expected.expect("projections");
        for ending in ["yml", "xml", "json"] {
            let path = folder.join(lens).with_extension(ending);
            let cameras = read(&path);
            assert_projections(&cameras, &expected, &path.display().to_string());
            for (ending, text) in
                [("toml", to_anipose_toml(&cameras)), ("out.yml", to_opencv_yaml(&cameras))]
            {
                let written = folder.join(lens).with_extension(ending);
                std::fs::write(&written, text).expect("written");
                let found = script(&python, "project", &written);
                assert_projections(&cameras, &found, &written.display().to_string());
            }
        }
    }
}
