//! The same two cameras as each tool writes them.

use std::fmt::Write;

use phalanx_camera::{Camera, Lens};
use phalanx_io::calibration::Unit;

use super::reference::{
    BROWN, FISHEYE, Numbers, assert_same, brown, cameras, fisheye, list, read, rows,
};

/// Asserts that files are read as the two cameras of a lens, and which notes come with them.
fn assert_read(
    files: &[(&str, String)],
    unit: Option<Unit>,
    lens: Lens,
    names: [&str; 2],
) -> Vec<String> {
    let calibration = read(files, unit).unwrap_or_else(|error| panic!("{error}\n{}", files[0].1));
    assert_same(&calibration.cameras, &cameras(lens), files[0].0);
    let found: Vec<&str> = calibration.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(found, names);
    calibration.notes
}

fn numbered(unit_mm: f64, lens: Lens) -> impl Iterator<Item = (usize, Camera, Numbers)> {
    let cameras = cameras(lens).into_iter().enumerate();
    cameras.map(move |(index, camera)| {
        let numbers = Numbers::of(&camera, unit_mm);
        (index, camera, numbers)
    })
}

/// A section as aniposelib and those after it write it.
fn anipose(
    header: &str,
    name: &str,
    size: &str,
    distortion: &[f64],
    rotation: &str,
    n: &Numbers,
) -> String {
    format!(
        "[{header}]\n{name}\nsize = {size}\nmatrix = {}\ndistortions = {}\nrotation = {rotation}\n\
         translation = {}\n",
        rows(&n.matrix, 3),
        list(distortion),
        list(&n.translation),
    )
}

#[test]
fn anipose_and_freemocap() {
    let mut text = String::new();
    for (index, camera, n) in numbered(1.0, brown()) {
        let (name, vector) = (format!("name = \"{}\"", camera.name), list(&n.vector));
        text += &anipose(&format!("cam_{index}"), &name, "[1280, 720]", &BROWN, &vector, &n);
        // FreeMoCap repeats the pose the other way round.
        write!(text, "id = \"{index}\"\nworld_position = {}\n\n", list(&n.position)).unwrap();
    }
    let anipose = text.clone() + "[metadata]\nadjusted = false\nerror = 0.42\n";
    let files = [("calibration.toml", anipose)];
    let mm = Some(Unit::MILLIMETRE);
    assert!(assert_read(&files, mm, brown(), ["left", "right"]).is_empty());
    assert!(read(&files, None).unwrap_err().to_string().contains("Anipose"));
    let board = "[metadata]\ngroundplane_applied = true\n[metadata.board]\nsquares_x = 5\n\
                 square_length_mm = 54.0\n";
    let files = [("x_camera_calibration.toml", text.replace("size =", "image_size =") + board)];
    assert!(assert_read(&files, None, brown(), ["left", "right"]).is_empty());
    assert!(read(&files, Some(Unit::METRE)).unwrap_err().to_string().contains("its unit is 1 mm"));
}

#[test]
fn caliscope_and_its_fisheyes() {
    for (lens, coefficients) in [(brown(), &BROWN[..]), (fisheye(), &FISHEYE[..])] {
        for key in ["cam_id", "port"] {
            let mut text = String::new();
            for (index, _, n) in numbered(1000.0, lens) {
                let extra = format!(
                    "{key} = {index}\nrotation_count = 0\nerror = 0.5\nexposure = -7\n\
                     grid_count = 39\nignore = false\nfisheye = {}",
                    coefficients.len() == 4
                );
                // Older files have matrices.
                let turn = if key == "port" { rows(&n.rotation, 3) } else { list(&n.vector) };
                let header = format!("cameras.{index}");
                text += &anipose(&header, &extra, "[1280, 720]", coefficients, &turn, &n);
            }
            text += "[cameras.7]\ncam_id = 7\nignore = true\nsize = [9, 9]\nmatrix = [[1, 0, 0], \
                     [0, 1, 0], [0, 0, 1]]\n";
            let files = [("camera_array.toml", text)];
            let notes = assert_read(&files, Some(Unit::METRE), lens, ["cam_0", "cam_1"]);
            assert_eq!(notes, ["camera `cam_7` is left out: the file says to ignore it"]);
            let error = read(&files, None).unwrap_err().to_string();
            assert!(error.contains("Caliscope writes metres"), "{error}");
        }
    }
}

#[test]
fn pose2sim() {
    let mut text = String::new();
    for (_, camera, n) in numbered(1000.0, brown()) {
        let (name, vector) =
            (format!("name = \"{}\"\nfisheye = false", camera.name), list(&n.vector));
        text += &anipose(&camera.name, &name, "[1280.0, 720.0]", &BROWN[..4], &vector, &n);
    }
    let files = [("Calib_scene.toml", text + "[metadata]\nadjusted = false\nerror = 0.0\n")];
    assert!(assert_read(&files, Some(Unit::METRE), brown(), ["left", "right"]).is_empty());
}

/// A matrix of OpenCV's storage in YAML, its numbers over several lines.
fn yaml_matrix(key: &str, rows: usize, numbers: &[f64]) -> String {
    let columns = numbers.len() / rows;
    let data = list(numbers).replacen(", ", ",\n       ", 1);
    format!(
        "{key}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   data: {data}\n"
    )
}

#[test]
fn easymocap() {
    let head = "%YAML:1.0\n---\nnames:\n  - \"01\"\n  - \"02\"\n".to_owned();
    let (mut intri, mut extri) = (head.clone(), head);
    for (index, _, n) in numbered(1000.0, brown()) {
        let key = |field: &str| format!("{field}_0{}", index + 1);
        intri += &yaml_matrix(&key("K"), 3, &n.matrix);
        intri += &yaml_matrix(&key("dist"), 1, &BROWN);
        write!(intri, "{}: 720\n{}: 1280\n", key("H"), key("W")).unwrap();
        extri += &yaml_matrix(&key("R"), 3, &n.vector);
        extri += &yaml_matrix(&key("Rot"), 3, &n.rotation);
        extri += &yaml_matrix(&key("T"), 3, &n.translation);
    }
    let files = [("intri.yml", intri.clone()), ("extri.yml", extri)];
    assert!(assert_read(&files, Some(Unit::METRE), brown(), ["01", "02"]).is_empty());
    let alone = read(&files[..1], Some(Unit::METRE)).unwrap_err().to_string();
    assert!(alone.contains("camera `01`: rotation is missing"), "{alone}");
    let mut sizeless: Vec<&str> = intri.lines().collect();
    sizeless.retain(|line| !line.starts_with(['H', 'W']));
    let files = [("intri.yml", sizeless.join("\n")), files[1].clone()];
    let error = read(&files, Some(Unit::METRE)).unwrap_err().to_string();
    assert!(error.contains("give the pictures' width and height"), "{error}");
}

/// The first camera's frame is the world, as stereo calibrations and chains have it.
fn from_the_first(unit_mm: f64) -> (Vec<Camera>, [f64; 9], [f64; 3]) {
    let mut both = cameras(brown());
    let first = both[0].extrinsics;
    let turn = both[1].extrinsics.rotation * first.rotation.transpose();
    let shift = both[1].extrinsics.translation - turn * first.translation;
    both[0].extrinsics.rotation = glam::DMat3::IDENTITY;
    both[0].extrinsics.translation = glam::DVec3::ZERO;
    both[1].extrinsics = phalanx_camera::Extrinsics { rotation: turn, translation: shift };
    (both, turn.transpose().to_cols_array(), (shift / unit_mm).to_array())
}

/// Asserts that cameras agree on a point in the first one's frame.
fn assert_chained(files: &[(&str, String)], unit: Unit) {
    let (expected, ..) = from_the_first(1.0);
    let found = read(files, Some(unit)).unwrap_or_else(|error| panic!("{error}")).cameras;
    let world = |point| cameras(brown())[0].extrinsics.to_camera(point);
    for point in [glam::DVec3::ZERO, glam::DVec3::new(60.0, -20.0, 90.0)] {
        for (found, expected) in found.iter().zip(&expected) {
            let seen = |camera: &Camera| camera.project(world(point)).expect("in view");
            assert!((seen(found) - seen(expected)).length() < 1e-6, "{}", files[0].0);
        }
    }
}

#[test]
fn opencv_stereo_files_and_their_rectification() {
    let (both, turn, shift) = from_the_first(25.0);
    let mut intrinsics = "%YAML:1.0\n---\n".to_owned();
    for (index, camera) in both.iter().enumerate() {
        let n = Numbers::of(camera, 25.0);
        intrinsics += &yaml_matrix(&format!("M{}", index + 1), 3, &n.matrix);
        intrinsics += &yaml_matrix(&format!("D{}", index + 1), 1, &BROWN);
    }
    intrinsics += "image_width: 1280\nimage_height: 720\n";
    let mut extrinsics = "%YAML:1.0\n---\n".to_owned();
    extrinsics += &yaml_matrix("R", 3, &turn);
    extrinsics += &yaml_matrix("T", 3, &shift);
    let halves = [("intrinsics.yml", intrinsics), ("extrinsics.yml", extrinsics.clone())];
    assert_chained(&halves, Unit::of_mm(25.0).unwrap());
    // R1 and R2 are turns of the rectified views here, not poses.
    for (key, rows) in [("R1", 3), ("R2", 3), ("P1", 3), ("P2", 3), ("Q", 4)] {
        extrinsics += &yaml_matrix(key, rows, &vec![0.5; if rows == 4 { 16 } else { 9 }]);
    }
    let halves = [halves[0].clone(), ("extrinsics.yml", extrinsics)];
    assert_chained(&halves, Unit::of_mm(25.0).unwrap());
}

/// Both cameras as OpenCV's storage has them in XML or JSON, each with its own pose.
#[test]
fn opencv_storage_in_xml_and_json() {
    let xml_matrix = |key: &str, rows: usize, numbers: &[f64]| {
        let data: Vec<String> = numbers.iter().map(f64::to_string).collect();
        format!(
            "<{key} type_id=\"opencv-matrix\">\n  <rows>{rows}</rows>\n  <cols>{}</cols>\n  \
             <dt>d</dt>\n  <data>\n    {}</data></{key}>\n",
            numbers.len() / rows,
            data.join(" "),
        )
    };
    let json_matrix = |key: &str, rows: usize, numbers: &[f64]| {
        format!(
            "\"{key}\": {{\"type_id\": \"opencv-matrix\", \"rows\": {rows}, \"cols\": {}, \"dt\": \
             \"d\", \"data\": {}}},\n",
            numbers.len() / rows,
            list(numbers),
        )
    };
    let (mut xml, mut json) = (String::new(), String::new());
    for (index, _, n) in numbered(1.0, brown()) {
        for (field, rows, numbers) in [
            ("M", 3, &n.matrix[..]),
            ("D", 1, &BROWN),
            ("R", 3, &n.rotation),
            ("T", 3, &n.translation),
        ] {
            let key = format!("{field}{}", index + 1);
            xml += &xml_matrix(&key, rows, numbers);
            json += &json_matrix(&key, rows, numbers);
        }
    }
    let size = "<image_width>1280</image_width><image_height>720</image_height>";
    let xml =
        format!("<?xml version=\"1.0\"?>\n<opencv_storage>\n{size}\n{xml}</opencv_storage>\n");
    let json = format!("{{{json}\"image_width\": 1280, \"image_height\": 720}}");
    for file in [("stereo.xml", xml), ("stereo.json", json)] {
        let notes = assert_read(&[file], Some(Unit::MILLIMETRE), brown(), ["cam1", "cam2"]);
        assert!(notes.is_empty(), "{notes:?}");
    }
}

#[test]
fn kalibr_chains() {
    let (both, turn, shift) = from_the_first(1000.0);
    let mut text = String::new();
    for (index, camera) in both.iter().enumerate() {
        let m = Numbers::of(camera, 1000.0).matrix;
        writeln!(text, "cam{index}:").unwrap();
        if index == 1 {
            text += "  T_cn_cnm1:\n";
            for row in 0..3 {
                let r = &turn[3 * row..3 * row + 3];
                writeln!(text, "  - {}", list(&[r[0], r[1], r[2], shift[row]])).unwrap();
            }
            text += "  - [0.0, 0.0, 0.0, 1.0]\n";
        }
        write!(
            text,
            "  camera_model: pinhole\n  intrinsics: {}\n  distortion_model: radtan\n  \
             distortion_coeffs: {}\n  resolution: [1280, 720]\n  rostopic: /cam{index}/image_raw\n  \
             cam_overlaps: [1]\n  timeshift_cam_imu: 0.0\n",
            list(&[m[0], m[4], m[2], m[5]]),
            list(&BROWN[..4]),
        )
        .unwrap();
    }
    assert_chained(&[("camchain.yaml", text.clone())], Unit::METRE);
    let equidistant = text.replace("radtan", "equidistant");
    let cameras = read(&[("camchain.yaml", equidistant)], Some(Unit::METRE)).unwrap().cameras;
    assert!(matches!(cameras[0].intrinsics.lens, Lens::Fisheye(_)));
    for (from, to) in [("radtan", "fov"), ("pinhole", "omni")] {
        let error = read(&[("camchain.yaml", text.replace(from, to))], Some(Unit::METRE));
        let error = error.unwrap_err().to_string();
        assert!(error.contains(&format!("`{to}` is a lens model that is not known")), "{error}");
    }
}

/// A rotation as a unit quaternion x y z w.
fn quaternion(camera: &Camera) -> [f64; 4] {
    glam::DQuat::from_mat3(&camera.extrinsics.rotation).to_array()
}

#[test]
fn colmap_counts_from_the_corner() {
    let mut inside = "# Camera list with one line of data per camera:\n".to_owned();
    let mut images = "# Image list with two lines of data per image:\n".to_owned();
    for (index, camera, n) in numbered(1000.0, brown()) {
        let (i, id) = (camera.intrinsics, index + 1);
        let [x, y, z, w] = quaternion(&camera);
        let [tx, ty, tz] = n.translation;
        writeln!(
            inside,
            "{id} OPENCV 1280 720 {} {} {} {} -0.1 0.02 0.001 -0.002",
            i.fx, i.fy, i.cx, i.cy
        )
        .unwrap();
        let points = if index == 0 { "" } else { "100.5 200.5 -1 300 400 17" };
        writeln!(images, "{id} {w} {x} {y} {z} {tx} {ty} {tz} {id} {}.png\n{points}", camera.name)
            .unwrap();
    }
    let files = [("cameras.txt", inside), ("images.txt", images)];
    assert!(assert_read(&files, Some(Unit::METRE), brown(), ["left", "right"]).is_empty());
    assert!(read(&files, None).unwrap_err().to_string().contains("arbitrary"));
    assert!(read(&files[..1], None).unwrap_err().to_string().contains("belong together"));
}

#[test]
fn qualisys_gives_poses_in_the_world() {
    let mut text = "<calibration><cameras>\n<camera serial=\"1\" model=\"Miqus M3\"/>\n".to_owned();
    for (index, _, n) in numbered(1.0, brown()) {
        let of_64 = |number: f64| number * 64.0;
        // x_cam = diag(1, −1, −1) M (x − c): undo the half turn; listed is M row by row.
        let r: Vec<f64> =
            (0..9).map(|k| if k < 3 { n.rotation[k] } else { -n.rotation[k] }).collect();
        let [x, y, z] = n.position;
        write!(
            text,
            "<camera serial=\"{}\" model=\"Miqus Video\" avg-residual=\"0.5\">\n\
             <fov_video left=\"8\" top=\"4\" right=\"1287\" bottom=\"723\"/>\n\
             <transform x=\"{x}\" y=\"{y}\" z=\"{z}\" r11=\"{}\" r12=\"{}\" r13=\"{}\" r21=\"{}\" \
             r22=\"{}\" r23=\"{}\" r31=\"{}\" r32=\"{}\" r33=\"{}\"/>\n\
             <intrinsic focalLengthU=\"{}\" focalLengthV=\"{}\" centerPointU=\"{}\" \
             centerPointV=\"{}\" radialDistortion1=\"{}\" radialDistortion2=\"{}\" \
             tangentalDistortion1=\"{}\" tangentalDistortion2=\"{}\"/></camera>\n",
            100 + index,
            r[0],
            r[1],
            r[2],
            r[3],
            r[4],
            r[5],
            r[6],
            r[7],
            r[8],
            of_64(n.matrix[0]),
            of_64(n.matrix[4]),
            of_64(n.matrix[2] + 8.0),
            of_64(n.matrix[5] + 4.0),
            of_64(BROWN[0]),
            of_64(BROWN[1]),
            of_64(BROWN[2]),
            of_64(BROWN[3]),
        )
        .unwrap();
    }
    let files = [("s.qca.txt", text + "</cameras></calibration>")];
    assert_read(&files, None, brown(), ["100", "101"]);
}

#[test]
fn vicon_gives_poses_in_the_world() {
    let perfect =
        phalanx_camera::Distortion { k1: -0.1, k2: 0.02, ..phalanx_camera::Distortion::NONE };
    let mut text = "<?xml version=\"1.0\"?>\n<Cameras>\n".to_owned();
    text += "<Camera DEVICEID=\"9\" TYPE=\"Vicon\" SYSTEM=\"\"/>\n";
    for (index, camera, n) in numbered(1.0, perfect.into()) {
        let [x, y, z, w] = quaternion(&camera);
        let [px, py, pz] = n.position;
        let m = n.matrix;
        writeln!(
            text,
            "<Camera DEVICEID=\"{index}\" TYPE=\"VideoInputDevice\" SYSTEM=\"DV\" \
             PIXEL_ASPECT_RATIO=\"{}\" SENSOR_SIZE=\"1280 720\"><KeyFrames>\
             <KeyFrame FOCAL_LENGTH=\"{}\" PRINCIPAL_POINT=\"{} {}\" ORIENTATION=\"{} {} {} {w}\" \
             POSITION=\"{px} {py} {pz}\" VICON_RADIAL2=\"ViconRadial2 0 0 -0.1 0.02\" \
             WORLD_ERROR=\"0.2\"/></KeyFrames></Camera>",
            m[0] / m[4],
            m[0],
            m[2],
            m[5],
            -x,
            -y,
            -z,
        )
        .unwrap();
    }
    let files = [("s.xcp", text + "</Cameras>\n")];
    let notes = assert_read(&files, None, perfect.into(), ["0", "1"]);
    assert!(notes[0].contains("radial distortion"), "{notes:?}");
}

#[test]
fn biocv_has_a_file_a_camera() {
    let files: Vec<(&str, String)> = numbered(1.0, brown())
        .map(|(index, _, n)| {
            let row = |numbers: &[f64]| {
                let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
                words.join(" ") + "\n"
            };
            let mut text = "1280\n720\n".to_owned();
            text += &n.matrix.chunks(3).map(row).collect::<String>();
            text += "\n";
            for (turn, shift) in n.rotation.chunks(3).zip(n.translation) {
                text += &row(&[turn[0], turn[1], turn[2], shift]);
            }
            text += "0 0 0 1\n\n";
            ([("left.calib"), ("right.calib")][index], text + &row(&BROWN))
        })
        .collect();
    assert!(assert_read(&files, None, brown(), ["left", "right"]).is_empty());
}

#[test]
fn panoptic_and_multical() {
    let entries: Vec<String> = numbered(10.0, brown())
        .map(|(index, camera, n)| {
            let column: Vec<f64> = n.translation.to_vec();
            format!(
                "{{\"name\": \"{}\", \"type\": \"hd\", \"resolution\": [1280, 720], \"panel\": 0, \
                 \"node\": {index}, \"K\": {}, \"distCoef\": {}, \"R\": {}, \"t\": {}}}",
                camera.name,
                rows(&n.matrix, 3),
                list(&BROWN),
                rows(&n.rotation, 3),
                rows(&column, 1),
            )
        })
        .collect();
    let panoptic = format!("{{\"calibDataSource\": \"x\", \"cameras\": [{}]}}", entries.join(", "));
    let cm = Some("cm".parse().unwrap());
    let notes = assert_read(&[("calib.json", panoptic)], cm, brown(), ["left", "right"]);
    assert_eq!(notes, ["not known and passed over: calibDataSource"]);

    let (both, turn, shift) = from_the_first(1000.0);
    let inside: Vec<String> = both
        .iter()
        .map(|camera| {
            let n = Numbers::of(camera, 1000.0);
            format!(
                "\"{}\": {{\"model\": \"standard\", \"image_size\": [1280, 720], \"K\": {}, \"dist\": \
                 [{}]}}",
                camera.name,
                rows(&n.matrix, 3),
                list(&BROWN),
            )
        })
        .collect();
    let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let multical = format!(
        "{{\"cameras\": {{{}}}, \"camera_poses\": {{\"left\": {{\"R\": {}, \"T\": [0, 0, 0]}}, \
         \"right_to_left\": {{\"R\": {}, \"T\": {}}}}}}}",
        inside.join(", "),
        rows(&identity, 3),
        rows(&turn, 3),
        list(&shift),
    );
    assert_chained(&[("calibration.json", multical)], Unit::METRE);
}
