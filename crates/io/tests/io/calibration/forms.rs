//! One calibration in all the shapes that scripts give its numbers.

use phalanx_camera::{Distortion, Lens};
use phalanx_io::calibration::{Calibration, Missing, Source, Unit};

use super::reference::{
    BROWN, FISHEYE, Numbers, RATIONAL, assert_same, brown, cameras, fisheye, list, read, rows,
};

/// A camera of the project's own JSON, with fields replaced or added.
fn entry(camera: &phalanx_camera::Camera, changes: &[(&str, &str)]) -> String {
    let n = Numbers::of(camera, 25.0);
    let mut fields = vec![
        ("name", format!("\"{}\"", camera.name)),
        ("width", "1280".to_owned()),
        ("height", "720".to_owned()),
        ("camera_matrix", rows(&n.matrix, 3)),
        ("distortion_coefficients", list(&BROWN)),
        ("rotation", rows(&n.rotation, 3)),
        ("translation", list(&n.translation)),
    ];
    let from_vector = [("VECTOR", list(&n.vector)), ("COLUMN", rows(&n.vector, 1))];
    let shape = [
        ("FLAT", list(&n.matrix)),
        ("SKEWED", skewed_matrix(&n.matrix)),
        ("NINE", list(&n.rotation)),
        ("TVEC", rows(&n.translation, 1)),
        ("POSE", pose_matrix(&n.rotation, &n.translation)),
        ("INVERSE", inverse_matrix(&n)),
    ];
    for (key, value) in changes {
        let mut value = (*value).to_owned();
        for (word, text) in from_vector.iter().chain(&shape) {
            value = value.replace(word, text);
        }
        fields.retain(|(known, _)| known != key);
        if !value.is_empty() {
            fields.push((key, value));
        }
    }
    let fields: Vec<String> =
        fields.iter().map(|(key, value)| format!("\"{key}\": {value}")).collect();
    format!("{{{}}}", fields.join(", "))
}

/// With what a fit leaves of a skew that it was told to leave out.
fn skewed_matrix(k: &[f64; 9]) -> String {
    rows(&[k[0], 1e-14, k[2], -1e-15, k[4], k[5], 0.0, 0.0, 1.0], 3)
}

fn pose_matrix(r: &[f64], t: &[f64]) -> String {
    let row = |i: usize| list(&[r[3 * i], r[3 * i + 1], r[3 * i + 2], t[i]]);
    format!("[{}, {}, {}, [0, 0, 0, 1]]", row(0), row(1), row(2))
}

fn inverse_matrix(n: &Numbers) -> String {
    let r = n.rotation;
    let transposed = [r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]];
    pose_matrix(&transposed, &n.position)
}

pub(crate) fn json(lens: Lens, changes: &[(&str, &str)]) -> String {
    let cameras: Vec<String> = cameras(lens).iter().map(|camera| entry(camera, changes)).collect();
    format!("{{\"cameras\": [{}]}}", cameras.join(", "))
}

pub(crate) fn squares() -> Option<Unit> {
    Unit::of_mm(25.0).ok()
}

fn assert_form(lens: Lens, changes: &[(&str, &str)]) -> Calibration {
    let text = json(lens, changes);
    let found = read(&[("c.json", text)], squares());
    let found = found.unwrap_or_else(|error| panic!("{changes:?}: {error}"));
    assert_same(&found.cameras, &cameras(lens), &format!("{changes:?}"));
    found
}

#[test]
fn numbers_come_in_every_shape() {
    let gone = ("width", "");
    for changes in [
        &[][..],
        &[("camera_matrix", "FLAT")],
        &[("camera_matrix", "SKEWED")],
        &[("rotation", "NINE")],
        &[("rotation", "VECTOR")],
        &[("rotation", "COLUMN")],
        &[("rotation", ""), ("rvec", "[VECTOR]")],
        &[("translation", "TVEC")],
        &[("translation", ""), ("tvec", "TVEC")],
        &[("rotation", ""), ("translation", ""), ("extrinsics", "POSE")],
        &[("width", "1280.0"), ("height", "720.0")],
        &[gone, ("height", ""), ("image_size", "[1280, 720]")],
        &[gone, ("height", ""), ("imageSize", "[[1280], [720]]")],
        &[("distortion_coefficients", "[[-0.1, 0.02, 0.001, -0.002, 0.0]]")],
        &[("distortion_coefficients", "[[-0.1], [0.02], [0.001], [-0.002]]")],
        &[("distortion_coefficients", "[-0.1, 0.02, 0.001, -0.002, 0, 0, 0, 0]")],
        &[("distortion_coefficients", "[-0.1, 0.02, 0.001, -0.002, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]")],
        &[("distortion_coefficients", ""), ("dist", "[-0.1, 0.02, 0.001, -0.002]")],
        &[
            ("distortion_coefficients", ""),
            ("k1", "-0.1"),
            ("k2", "0.02"),
            ("p1", "0.001"),
            ("p2", "-0.002"),
        ],
        &[("fisheye", "false"), ("camera_model", "\"pinhole\"")],
    ] {
        assert_eq!(assert_form(brown(), changes).notes, [""; 0], "{changes:?}");
    }
}

#[test]
fn lenses_are_read_by_any_name() {
    let perfect = Lens::PERFECT;
    for none in ["null", "[]", "[[]]", "[0, 0, 0, 0]", ""] {
        assert_form(perfect, &[("distortion_coefficients", none)]);
    }
    let four = list(&FISHEYE);
    for (key, value) in [
        ("fisheye", "true"),
        ("model", "\"fisheye\""),
        ("camera_model", "\"kannala_brandt\""),
        ("distortion_model", "\"equidistant\""),
        ("lens_type", "\"OPENCV_FISHEYE\""),
        ("type", "\"Fisheye\""),
        ("some_key", "\"Kannala-Brandt\""),
    ] {
        assert_form(fisheye(), &[("distortion_coefficients", &four), (key, value)]);
    }
    let rational = Distortion::from_coefficients(&RATIONAL).unwrap();
    let eight = list(&RATIONAL);
    assert_form(rational.into(), &[("distortion_coefficients", &eight)]);
    let mut twelve = RATIONAL.to_vec();
    twelve.extend([1e-3, 0.0, -1e-3, 0.0]);
    let prism = Distortion { s1: 1e-3, s3: -1e-3, ..rational };
    assert_form(prism.into(), &[("distortion_coefficients", &list(&twelve))]);
}

#[test]
fn keys_that_are_not_known_are_named() {
    let notes = assert_form(brown(), &[("vignetting", "0.5"), ("iso", "100")]).notes;
    assert_eq!(notes, ["not known and passed over: vignetting, iso"]);
}

#[test]
fn poses_in_the_world_are_inverted_where_they_say_so() {
    for key in ["camera_to_world", "c2w", "T_world_cam", "cam2world"] {
        let changes = [("rotation", ""), ("translation", ""), (key, "INVERSE")];
        let notes = assert_form(brown(), &changes).notes;
        assert!(notes[0].contains("was inverted"), "{notes:?}");
    }
}

#[test]
fn texts_come_in_every_encoding() {
    let text = json(brown(), &[]);
    let expected = cameras(brown());
    let wide = |unit: fn(u16) -> [u8; 2], mark: [u8; 2]| {
        let mut bytes = mark.to_vec();
        bytes.extend(text.encode_utf16().flat_map(unit));
        bytes
    };
    for bytes in [
        text.clone().into_bytes(),
        [b"\xef\xbb\xbf", text.as_bytes()].concat(),
        text.replace(", ", ",\r\n").into_bytes(),
        wide(u16::to_le_bytes, [0xff, 0xfe]),
        wide(u16::to_be_bytes, [0xfe, 0xff]),
    ] {
        let file = Source { name: "c.json", bytes: &bytes };
        let missing = Missing { unit: squares(), size: None };
        assert_same(&Calibration::read(&[file], &missing).unwrap().cameras, &expected, "bytes");
    }
}

#[test]
fn rounded_rotations_are_made_rotations_and_said() {
    let rounded = |digits: usize| {
        let mut text = String::new();
        for camera in cameras(brown()) {
            let n = Numbers::of(&camera, 25.0);
            let r: Vec<String> = n.rotation.iter().map(|e| format!("{e:.digits$}")).collect();
            text += if text.is_empty() { "" } else { ", " };
            text += &entry(&camera, &[("rotation", &format!("[{}]", r.join(", ")))]);
        }
        read(&[("c.json", format!("{{\"cameras\": [{text}]}}"))], squares())
    };
    let four = rounded(4).unwrap();
    assert_eq!(four.notes.len(), 2);
    assert!(four.notes[0].contains("its rotation is rounded"), "{:?}", four.notes);
    assert_eq!(rounded(7).unwrap().notes, [""; 0]);
    let one = rounded(1).unwrap_err().to_string();
    assert!(one.contains("camera `left`: rotation is no rotation, by"), "{one}");
}

#[test]
fn names_are_kept_and_the_order_is_the_files() {
    let with = |names: [&str; 2]| {
        let text = json(brown(), &[]);
        let text = text.replace("\"left\"", names[0]).replace("\"right\"", names[1]);
        let found = read(&[("c.json", text)], squares()).unwrap();
        let names: Vec<String> = found.cameras.into_iter().map(|camera| camera.name).collect();
        (names.join(" "), found.notes.join("; "))
    };
    assert_eq!(with(["0", "1"]).0, "0 1");
    assert_eq!(with(["\"Kamera-Süd\"", "\"b\""]).0, "Kamera-Süd b");
    let (names, notes) = with(["\"cam 1\"", "\"cam 2\""]);
    assert_eq!(names, "cam_1 cam_2");
    assert!(notes.contains("camera `cam 1` is called `cam_1`"), "{notes}");
    let (names, notes) = with(["\"cam_10\"", "\"cam_2\""]);
    assert_eq!(names, "cam_10 cam_2");
    assert!(notes.contains("the file's order, cam_10, cam_2"), "{notes}");
}
