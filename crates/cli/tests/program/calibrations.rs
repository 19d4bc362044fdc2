//! Calibrations become rig files, or are refused by name.

use phalanx_camera::Rig;
use tempfile::TempDir;

use crate::desk::{Outcome, run};

pub(crate) const CALIBRATION: &str = r#"{ "cameras": [
    { "name": "a", "width": 640, "height": 480,
      "camera_matrix": [[600, 0, 319.5], [0, 600, 239.5], [0, 0, 1]],
      "distortion_coefficients": [0, 0, 0, 0, 0],
      "rotation": [[1, 0, 0], [0, -1, 0], [0, 0, -1]], "translation": [0, 0, 20] },
    { "name": "b", "width": 640, "height": 480,
      "camera_matrix": [[600, 0, 319.5], [0, 600, 239.5], [0, 0, 1]],
      "distortion_coefficients": [0, 0, 0, 0, 0],
      "rotation": [[1, 0, 0], [0, 0, -1], [0, 1, 0]], "translation": [0, 0, 20] } ] }"#;

/// Imports a calibration with further arguments; the outcome, and the rig file if there is one.
fn import(calibration: &str, arguments: &[&str]) -> (Outcome, Option<String>) {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("c.json"), calibration).unwrap();
    let command = ["import-calibration", "c.json", "--out", "rig.toml"];
    let outcome = run(folder.path(), command.iter().chain(arguments));
    (outcome, std::fs::read_to_string(folder.path().join("rig.toml")).ok())
}

#[test]
fn a_calibration_becomes_a_rig_file() {
    let (outcome, toml) =
        import(CALIBRATION, &["--square-mm", "50", "--forearm", "-1,0,0", "--size", "80,90,100"]);
    assert_eq!((outcome.code, outcome.err.as_str()), (Some(0), ""));
    let rig = Rig::from_toml(&toml.unwrap()).unwrap();
    assert_eq!(rig.cameras[0].centre().z, 1000.0);
    assert_eq!(rig.volume.forearm.to_array(), [-1.0, 0.0, 0.0]);
    assert_eq!(rig.volume.size.to_array(), [80.0, 90.0, 100.0]);
    assert!(rig.volume.center.length() < 1e-9);
}

#[test]
fn what_contradicts_itself_is_refused_and_nothing_is_written() {
    let square: &[&str] = &["--square-mm", "50"];
    let twice = CALIBRATION.replace("\"b\"", "\"a\"");
    let mirrored = CALIBRATION.replacen("[0, 0, -1]]", "[0, 0, 1]]", 1);
    let one = CALIBRATION.split_at(CALIBRATION.find(",\n    { \"name\": \"b\"").unwrap()).0;
    let one = one.to_owned() + "] }";
    let away: &[&str] = &["--square-mm", "50", "--center", "0,0,3000"];
    for (calibration, arguments, part) in [
        (twice.as_str(), square, "c.json: camera `a`: two cameras have this name"),
        (&mirrored, square, "c.json: camera `a`: rotation is a reflection"),
        (&one, square, "c.json: give --center, --forearm and --up"),
        (CALIBRATION, &["--square-mm", "0"], "a unit of 0 mm is no length"),
        (CALIBRATION, away, "camera `a`: the volume's center_mm lies behind it"),
        (CALIBRATION, &["--square-mm", "50", "--up", "0,1"], "expected X,Y,Z"),
        ("{", square, "c.json: calibration: EOF"),
    ] {
        let (outcome, toml) = import(calibration, arguments);
        assert_eq!((outcome.code, toml), (Some(2), None), "{part}");
        assert!(outcome.err.contains(part), "no '{part}' in: {}", outcome.err);
    }
}
