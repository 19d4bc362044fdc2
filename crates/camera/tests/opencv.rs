//! Calibrations in OpenCV's conventions, and everything that can contradict itself in one.

use glam::{DVec2, DVec3};
use phalanx_camera::{Error, Rig, Volume, cameras_from_opencv_json};

const SQUARE_MM: f64 = 50.0;

/// Two cameras 20 squares above the origin, one of them turned by a quarter about the x axis.
const CALIBRATION: &str = r#"{ "note": "units are squares", "cameras": [
    { "name": "top", "width": 640, "height": 480,
      "camera_matrix": [[600, 0, 319.5], [0, 601, 239.5], [0, 0, 1]],
      "distortion_coefficients": [-0.1, 0.02, 0.001, -0.002, 0.0],
      "rotation": [[1, 0, 0], [0, -1, 0], [0, 0, -1]], "translation": [0, 0, 20] },
    { "name": "front", "width": 640, "height": 480,
      "camera_matrix": [[600, 0, 319.5], [0, 600, 239.5], [0, 0, 1]],
      "distortion_coefficients": [],
      "rotation": [[1, 0, 0], [0, 0, -1], [0, 1, 0]], "translation": [0, 0, 20] } ] }"#;

fn refused(edits: &[(&str, &str)]) -> Error {
    let mut text = CALIBRATION.to_owned();
    for (from, to) in edits {
        assert!(text.contains(from), "{from} is not in the text");
        text = text.replacen(from, to, 1);
    }
    cameras_from_opencv_json(&text, SQUARE_MM).unwrap_err()
}

#[test]
fn units_axes_and_pixel_centres_are_brought_to_ours() {
    let cameras = cameras_from_opencv_json(CALIBRATION, SQUARE_MM).unwrap();
    let top = &cameras[0];
    assert_eq!(top.name, "top");
    assert!((top.centre() - DVec3::new(0.0, 0.0, 1000.0)).length() < 1e-9);
    // OpenCV's principal point 319.5, 239.5 is the middle of the picture.
    assert_eq!(top.project(DVec3::ZERO), Some(DVec2::new(320.0, 240.0)));
    assert_eq!(top.intrinsics.lens.coefficients()[3], -0.002);
    assert!(cameras[1].intrinsics.lens.is_perfect());
}

#[test]
fn a_volume_lies_where_the_axes_meet_and_makes_a_rig() {
    let cameras = cameras_from_opencv_json(CALIBRATION, SQUARE_MM).unwrap();
    let volume = Volume::between(&cameras, 300.0).unwrap();
    assert!(volume.center.length() < 1e-9);
    assert!(volume.up.z > 0.0 && volume.up.y < 0.0 && volume.forearm == DVec3::Y);
    let rig = Rig { cameras, volume };
    assert_eq!(Rig::from_toml(&rig.to_toml().unwrap()), Ok(rig.clone()));
    assert!(matches!(Volume::between(&rig.cameras[..1], 300.0), Err(Error::TooFewRays { .. })));
}

type Check = fn(&Error) -> bool;

#[test]
fn calibrations_that_contradict_themselves_are_refused_by_name() {
    for unit_mm in [0.0, -50.0, f64::NAN, f64::INFINITY] {
        let error = cameras_from_opencv_json(CALIBRATION, unit_mm).unwrap_err();
        assert!(matches!(error, Error::Unit { .. }), "{error}");
    }
    let cases: [(&str, &str, Check); 10] = [
        ("[600, 0, 319.5]", "[600, 2, 319.5]", |e| matches!(e, Error::CameraMatrix { .. })),
        ("[0, 0, 1]", "[0, 0, 2]", |e| matches!(e, Error::CameraMatrix { .. })),
        ("[600, 0, 319.5]", "[-600, 0, 319.5]", |e| matches!(e, Error::FocalLength { .. })),
        ("[-0.1, 0.02, 0.001, -0.002, 0.0]", "[-0.1, 0.02, 0.001]", |e| {
            matches!(e, Error::DistortionCount { found: 3, .. })
        }),
        ("[0, 0, -1]]", "[0, 0, 1]]", |e| matches!(e, Error::Reflection { .. })),
        ("[0, 0, -1]]", "[0, 0.1, -1]]", |e| matches!(e, Error::NotOrthonormal { .. })),
        ("\"width\": 640", "\"width\": 0", |e| matches!(e, Error::ImageSize { .. })),
        ("\"name\": \"top\"", "\"name\": \"../top\"", |e| matches!(e, Error::Name { .. })),
        ("[0, 0, 20]", "[0, 0, 1e999]", |e| matches!(e, Error::Json { .. })),
        ("\"translation\"", "\"tvec\"", |e| matches!(e, Error::Json { .. })),
    ];
    for (from, to, check) in cases {
        let error = refused(&[(from, to)]);
        assert!(check(&error), "{from} → {to}: {error}");
    }
    assert_eq!(cameras_from_opencv_json("{\"cameras\": []}", 1.0), Err(Error::NoCamera));
    assert!(matches!(cameras_from_opencv_json("[1", 1.0), Err(Error::Json { .. })));
}
