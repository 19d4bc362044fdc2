//! Calibrations, written for other tools.

use glam::{DMat3, DQuat};
use phalanx_camera::{Camera, Lens};

use crate::calibration::record::{CameraMatrix, Record};

/// The cameras as aniposelib, Anipose, Caliscope and Pose2Sim read them: `calibration.toml`, in
/// millimetres.
///
/// ```
/// use glam::DVec3;
/// use phalanx_camera::{Camera, Intrinsics};
/// use phalanx_io::calibration::{Calibration, Missing, Source, to_anipose_toml};
///
/// let inside = Intrinsics::pinhole(640, 480, 600.0);
/// let above = Camera::look_at("above", inside, DVec3::Y * 700.0, DVec3::ZERO, DVec3::X)?;
/// let text = to_anipose_toml(&[above.clone()]);
/// let file = Source { name: "calibration.toml", bytes: text.as_bytes() };
/// let read = Calibration::read(&[file], &Missing::default())?; // the file says its unit
/// assert_eq!(read.cameras[0].intrinsics, above.intrinsics);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_anipose_toml(cameras: &[Camera]) -> String {
    let digits = cameras.len().saturating_sub(1).to_string().len();
    let section = |(index, camera): (usize, &Camera)| {
        let Written { matrix, coefficients, vector, .. } = Written::of(camera);
        let rows: Vec<String> = matrix.chunks(3).map(list).collect();
        let [width, height] = [camera.intrinsics.width, camera.intrinsics.height];
        format!(
            "[cam_{index:0digits$}]\nname = \"{}\"\nsize = [{width}, {height}]\nmatrix = [{}]\n\
             distortions = {}\nrotation = {}\ntranslation = {}\n{}\n",
            camera.name,
            rows.join(", "),
            list(&coefficients),
            list(&vector),
            list(&camera.extrinsics.translation.to_array()),
            if is_fisheye(camera) { "fisheye = true\n" } else { "" },
        )
    };
    let sections: String = cameras.iter().enumerate().map(section).collect();
    sections + "[metadata]\nadjusted = false\nerror = 0.0\nunit = \"mm\"\n"
}

fn is_fisheye(camera: &Camera) -> bool {
    matches!(camera.intrinsics.lens, Lens::Fisheye(_))
}

/// The cameras as OpenCV's `FileStorage` and EasyMocap read them, all in one YAML file, in
/// millimetres: `names`, and for each name K, dist, R (a rotation vector), Rot (a matrix), T, H and W.
pub fn to_opencv_yaml(cameras: &[Camera]) -> String {
    let names: Vec<String> = cameras.iter().map(|camera| format!("\"{}\"", camera.name)).collect();
    let head = format!("%YAML:1.0\n---\nunit: \"mm\"\nnames: [{}]\n", names.join(", "));
    head + &cameras.iter().map(opencv_keys).collect::<String>()
}

/// What a camera has in OpenCV's storage.
fn opencv_keys(camera: &Camera) -> String {
    let Written { matrix, coefficients, vector, rotation } = Written::of(camera);
    let translation = camera.extrinsics.translation.to_array();
    let fields: [(&str, usize, &[f64]); 5] = [
        ("K", 3, &matrix),
        ("dist", 1, &coefficients),
        ("R", 3, &vector),
        ("Rot", 3, &rotation),
        ("T", 3, &translation),
    ];
    let name = &camera.name;
    let field = |(field, rows, numbers): (&str, usize, &[f64])| {
        let (columns, data) = (numbers.len() / rows, list(numbers));
        format!(
            "{field}_{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {columns}\n   dt: d\n   \
             data: {data}\n"
        )
    };
    let [width, height] = [camera.intrinsics.width, camera.intrinsics.height];
    let size = format!("H_{name}: {height}\nW_{name}: {width}\n");
    let lens = if is_fisheye(camera) { format!("fisheye_{name}: 1\n") } else { String::new() };
    fields.into_iter().map(field).collect::<String>() + &size + &lens
}

/// A camera's numbers in OpenCV's conventions, matrices row by row.
struct Written {
    matrix: [f64; 9],
    coefficients: Vec<f64>,
    /// The rotation as a vector.
    vector: [f64; 3],
    rotation: [f64; 9],
}

impl Written {
    fn of(camera: &Camera) -> Self {
        let Record { matrix, coefficients, pose, .. } = Record::of_camera(camera.clone());
        let CameraMatrix { fx, fy, cx, cy } = matrix;
        Self {
            matrix: [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
            coefficients,
            vector: rotation_vector(&pose.rotation),
            rotation: pose.rotation.transpose().to_cols_array(),
        }
    }
}

/// The turn's axis, as long as its angle.
fn rotation_vector(rotation: &DMat3) -> [f64; 3] {
    let turn = DQuat::from_mat3(rotation).normalize();
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let half = turn.xyz();
    let angle = 2.0 * half.length().atan2(turn.w);
    (half.normalize_or_zero() * angle).to_array()
}

/// Numbers in brackets, which read back exactly.
fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    format!("[{}]", numbers.join(", "))
}
