//! The cameras that every file in these tests is of, and their numbers as files have them.

use glam::{DMat3, DVec2, DVec3};
use phalanx_camera::{Camera, Distortion, Fisheye, Intrinsics, Lens};
use phalanx_io::Result;
use phalanx_io::calibration::{Calibration, Missing, Source, Unit};

pub(crate) const BROWN: [f64; 5] = [-0.1, 0.02, 0.001, -0.002, 0.0];
pub(crate) const RATIONAL: [f64; 8] = [-0.1, 0.02, 0.001, -0.002, 0.003, 0.05, -0.01, 0.002];
pub(crate) const FISHEYE: [f64; 4] = [-0.0059, 0.0159, -0.0242, 0.0155];

pub(crate) fn brown() -> Lens {
    Distortion::from_coefficients(&BROWN).unwrap().into()
}

pub(crate) fn fisheye() -> Lens {
    Fisheye::from_coefficients(&FISHEYE).unwrap().into()
}

/// Two cameras half a metre from the hand.
pub(crate) fn cameras(lens: Lens) -> Vec<Camera> {
    let inside =
        Intrinsics { width: 1280, height: 720, fx: 900.25, fy: 901.5, cx: 641.75, cy: 357.5, lens };
    let camera = |name: &str, x: f64| {
        let at = DVec3::new(x, 480.0, -150.0);
        Camera::look_at(name, inside, at, DVec3::new(0.0, 20.0, 60.0), DVec3::Z).unwrap()
    };
    vec![camera("left", -250.0), camera("right", 310.0)]
}

/// A camera's numbers as OpenCV has them, lengths in a unit of so many millimetres.
pub(crate) struct Numbers {
    pub(crate) matrix: [f64; 9],
    pub(crate) rotation: [f64; 9],
    pub(crate) vector: [f64; 3],
    pub(crate) translation: [f64; 3],
    /// Of the camera in the world.
    pub(crate) position: [f64; 3],
}

impl Numbers {
    pub(crate) fn of(camera: &Camera, unit_mm: f64) -> Self {
        let Intrinsics { fx, fy, cx, cy, .. } = camera.intrinsics;
        let rotation = camera.extrinsics.rotation;
        Self {
            matrix: [fx, 0.0, cx - 0.5, 0.0, fy, cy - 0.5, 0.0, 0.0, 1.0],
            rotation: rotation.transpose().to_cols_array(),
            vector: rotation_vector(&rotation).to_array(),
            translation: (camera.extrinsics.translation / unit_mm).to_array(),
            position: (camera.centre() / unit_mm).to_array(),
        }
    }
}

/// By Rodrigues, from the matrix's skew part.
fn rotation_vector(r: &DMat3) -> DVec3 {
    let skew =
        DVec3::new(r.y_axis.z - r.z_axis.y, r.z_axis.x - r.x_axis.z, r.x_axis.y - r.y_axis.x);
    let angle = (0.5 * skew.length()).atan2(0.5 * (r.x_axis.x + r.y_axis.y + r.z_axis.z - 1.0));
    skew.normalize() * angle
}

pub(crate) fn list(numbers: &[f64]) -> String {
    format!("{numbers:?}")
}

/// Rows of so many numbers, in brackets.
pub(crate) fn rows(numbers: &[f64], columns: usize) -> String {
    let rows: Vec<String> = numbers.chunks(columns).map(list).collect();
    format!("[{}]", rows.join(", "))
}

/// Reads files, each with its name.
pub(crate) fn read(files: &[(&str, String)], unit: Option<Unit>) -> Result<Calibration> {
    let sources: Vec<Source<'_>> =
        files.iter().map(|(name, text)| Source { name, bytes: text.as_bytes() }).collect();
    Calibration::read(&sources, &Missing { unit, size: None })
}

/// Asserts that cameras see what the reference's see, to a millionth of a pixel.
pub(crate) fn assert_same(found: &[Camera], expected: &[Camera], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(expected) {
        let size = |camera: &Camera| (camera.intrinsics.width, camera.intrinsics.height);
        assert_eq!(size(found), size(expected), "{what}");
        for (x, y, z) in [(0.0, 0.0, 0.0), (90.0, 40.0, 10.0), (-70.0, -30.0, 120.0)] {
            let point = DVec3::new(x, y, z);
            let seen = |camera: &Camera| camera.project(point).expect("in view");
            let off: DVec2 = seen(found) - seen(expected);
            assert!(off.length() < 1e-6, "{what}: camera {} is {off} px off", found.name);
        }
    }
}
