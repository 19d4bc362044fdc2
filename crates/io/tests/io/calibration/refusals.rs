//! What is refused, and in which words.

use phalanx_camera::Lens;
use phalanx_io::calibration::{Calibration, Missing, Source, Unit};

use super::forms::{json, squares};
use super::reference::{brown, read};

fn refused(changes: &[(&str, &str)], words: &str) {
    let error = read(&[("c.json", json(brown(), changes))], squares()).unwrap_err().to_string();
    assert!(error.contains(words), "{changes:?}: no '{words}' in: {error}");
}

#[test]
fn fields_that_cannot_be_right_are_refused_by_camera_and_name() {
    let matrix = "camera_matrix";
    for (key, value, words) in [
        ("camera_matrix", "", "camera `left`: camera_matrix is missing"),
        (matrix, "[[900, 2, 640], [0, 900, 360], [0, 0, 1]]", "is not [fx 0 cx; 0 fy cy; 0 0 1]"),
        (matrix, "[[900, 0, 0], [0, 900, 0], [640, 360, 1]]", "camera_matrix is transposed"),
        (matrix, "[[900, 0, 640], [0, 900, 360]]", "camera_matrix holds 6 numbers, not 9"),
        (matrix, "[[-900, 0, 640], [0, 900, 360], [0, 0, 1]]", "focal_px [-900, 900]"),
        (matrix, "\"identity\"", "camera_matrix holds something that is no number"),
        ("rotation", "", "rotation is missing: the file does not say where the camera stands"),
        ("rotation", "[90, 0, 45]", "Euler angles"),
        ("rotation", "[[1, 0, 0], [0, 1, 0], [0, 0, -1]]", "rotation is a reflection"),
        ("rotation", "[[1, 0, 0], [0, 1, 0], [0, 0.1, 1]]", "rotation is no rotation, by"),
        ("rotation", "[0, 0, 0, 1]", "rotation holds 4 numbers"),
        ("translation", "", "translation is missing"),
        ("translation", "[1, 2]", "translation holds 2 numbers, not 3"),
        ("distortion_coefficients", "[0.1, 0, 0]", "3 distortion coefficients"),
        ("camera_model", "\"omni\"", "camera_model `omni` is a lens model that is not known"),
        ("distortion_model", "\"division\"", "`division` is a lens model"),
        ("fisheye", "true", "5 distortion coefficients"),
        ("width", "", "size is not in the file"),
        ("width", "1280.5", "1280.5×720 px is no picture's"),
        ("width", "0", "0×720 px"),
        ("convention", "\"camera_to_world\"", "convention is a pose in the world"),
    ] {
        let changes = [(key, value)];
        let changes = if key == "fisheye" {
            vec![("distortion_coefficients", "[1, 0, 0, 0, 1]"), changes[0]]
        } else {
            changes.to_vec()
        };
        refused(&changes, words);
    }
    let turned = [("width", "720"), ("height", "1280"), ("camera_matrix", "[900, 900, 900, 300]")];
    refused(&turned, "are width and height swapped");
    for pose in ["position", "pose", "transform_matrix"] {
        let changes = [("translation", ""), (pose, "[1, 2, 3]")];
        refused(&changes, &format!("{pose} is a pose in the world"));
    }
}

#[test]
fn units_and_distances_are_checked() {
    let text = json(Lens::PERFECT, &[]);
    let with = |unit: Option<Unit>| read(&[("c.json", text.clone())], unit);
    let error = with(None).unwrap_err().to_string();
    assert!(error.contains("give the unit, mm, m or the millimetres"), "{error}");
    let error = with(Some(Unit::METRE)).unwrap_err().to_string();
    assert!(error.contains("cameras `left` and `right` are 22400.0 mm apart"), "{error}");
    let tiny = with(Some(Unit::of_mm(0.5).unwrap())).unwrap_err().to_string();
    assert!(tiny.contains("11.2 mm apart"), "{tiny}");
    for unit in ["0", "-1", "nan", "inf", "inch"] {
        assert!(unit.parse::<Unit>().is_err(), "{unit}");
    }
    let stated = text.replacen('{', "{\"unit\": \"mm\", ", 1);
    assert!(read(&[("c.json", stated)], squares()).is_err());
}

#[test]
fn sizes_that_differ_are_refused() {
    let text = json(brown(), &[]);
    let size = |size| {
        let missing = Missing { unit: squares(), size };
        Calibration::read(&[Source { name: "c.json", bytes: text.as_bytes() }], &missing)
    };
    assert!(size(Some((1280, 720))).is_ok());
    let error = size(Some((640, 360))).unwrap_err().to_string();
    assert!(error.contains("size is 1280×720 px in the file and 640×360"), "{error}");
}

#[test]
fn texts_that_are_no_calibration_say_why() {
    let deep = "[".repeat(100_000);
    let long = " ".repeat(2 << 20);
    let wide = format!("a = [{}1]", "1,".repeat(150_000));
    let aliases = format!("a: &a {}\nb: [{}]", "x".repeat(100_000), "*a,".repeat(100_000));
    let elements = format!("<opencv_storage>{}</opencv_storage>", "<a/>".repeat(200_000));
    for (text, words) in [
        ("", "the file is empty"),
        ("\u{feff} \n", "the file is empty"),
        ("hello", "it is not recognised"),
        ("{", "EOF while parsing"),
        ("{}", "it holds no camera"),
        ("{\"a\": 1, \"b\": [2]}", "no camera is recognised in it; it has a, b"),
        ("{\"cameras\": []}", "no camera is recognised"),
        ("{\"a\": 1, \"a\": 2}", "`a` stands twice"),
        ("{\"cameras\": [{\"K\": [NaN, 0]}]}", "line 1: NaN and Infinity are not JSON"),
        ("a: 1\na: 2\n", "`a` stands twice at line"),
        ("a: &x [1]\nb: *x\n", "no camera is recognised"),
        ("[cam]\nmatrix = 1\n", "no camera is recognised"),
        ("[cam\n", "calibration:"),
        ("<a/>", "<a> is not recognised"),
        ("<Cameras></Cameras>", "it holds no camera"),
        ("<a", "calibration:"),
        (deep.as_str(), "recursion limit"),
        (long.as_str(), "at most 1 MiB is read"),
        (wide.as_str(), "292 KiB; of TOML, 256 are read"),
        (aliases.as_str(), "more than 200000 values"),
        (elements.as_str(), "nodes limit reached"),
        ("1280\n720\n1 2\n", "is not laid out as bioCV's .calib"),
        ("1 THIN_PRISM_FISHEYE 640 480 1 2 3\n", "is not known: use PINHOLE"),
    ] {
        let error = read(&[("c", text.to_owned())], squares()).unwrap_err().to_string();
        assert!(error.contains(words) && error.len() < 1000, "no '{words}' in: {error}");
    }
    let file = Source { name: "c", bytes: b"\x89PNG\r\n\x1a\n\0" };
    let error = Calibration::read(&[file], &Missing::default()).unwrap_err().to_string();
    assert!(error.contains("no text in UTF-8"), "{error}");
}

#[test]
fn files_that_do_not_belong_together_are_refused() {
    let text = json(brown(), &[]);
    let other = text.replacen("900.25", "899.0", 2);
    let error = read(&[("a.json", text.clone()), ("b.json", other)], squares()).unwrap_err();
    assert!(error.to_string().contains("differs between the files"), "{error}");
    let biocv = "9\n9\n1 0 1\n0 1 1\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 0\n".to_owned();
    let error = read(&[("a.json", text.clone()), ("b.calib", biocv)], squares()).unwrap_err();
    assert!(error.to_string().contains("different tools"), "{error}");
    let error = read(&[("a.json", text), ("b.json", "{".to_owned())], squares()).unwrap_err();
    assert!(error.to_string().contains("b.json: EOF"), "{error}");
    let twice = json(brown(), &[("name", "\"a\"")]);
    let error = read(&[("a.json", twice)], squares()).unwrap_err();
    assert!(error.to_string().contains("two cameras have this name"), "{error}");
}
