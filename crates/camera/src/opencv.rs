//! Calibrations as OpenCV's users write them.

use glam::{DMat3, DVec3};
use serde::Deserialize;

use crate::{Camera, Distortion, Error, Extrinsics, Intrinsics, Result};

#[derive(Deserialize)]
struct Calibration {
    cameras: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    name: String,
    width: u32,
    height: u32,
    /// Row by row.
    camera_matrix: [[f64; 3]; 3],
    distortion_coefficients: Vec<f64>,
    /// Row by row.
    rotation: [[f64; 3]; 3],
    translation: DVec3,
}

/// Reads a calibration in OpenCV's conventions from JSON.
///
/// Its `cameras` have `name`, `width` and `height`, `camera_matrix` (three rows),
/// `distortion_coefficients` (OpenCV's 0, 4, 5, 8, 12 or 14), `rotation` (three rows) and
/// `translation`, with x_cam = R x_world + t. Lengths are in units of `unit_mm`, such as the
/// squares of a chessboard. Half a pixel is added to the principal point, since OpenCV counts
/// from the centre of the first pixel.
///
/// # Errors
/// Text of another form, a unit that is no length, or a camera that contradicts itself: each
/// names the camera and the field.
///
/// ```
/// let json = r#"{"cameras": [{
///     "name": "left", "width": 640, "height": 480,
///     "camera_matrix": [[600, 0, 319.5], [0, 600, 239.5], [0, 0, 1]],
///     "distortion_coefficients": [],
///     "rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
///     "translation": [0, 0, 20]
/// }]}"#;
/// let cameras = phalanx_camera::cameras_from_opencv_json(json, 25.0)?; // squares of 25 mm
/// assert_eq!(cameras[0].intrinsics.cx, 320.0);
/// assert_eq!(cameras[0].extrinsics.translation.z, 500.0);
/// # Ok::<(), phalanx_camera::Error>(())
/// ```
pub fn cameras_from_opencv_json(text: &str, unit_mm: f64) -> Result<Vec<Camera>> {
    if !(unit_mm > 0.0 && unit_mm.is_finite()) {
        return Err(Error::Unit { unit_mm });
    }
    let calibration: Calibration =
        serde_json::from_str(text).map_err(|e| Error::Json { message: e.to_string() })?;
    if calibration.cameras.is_empty() {
        return Err(Error::NoCamera);
    }
    calibration.cameras.into_iter().map(|entry| entry.into_camera(unit_mm)).collect()
}

impl Entry {
    fn into_camera(self, unit_mm: f64) -> Result<Camera> {
        let [[fx, skew, cx], [zero, fy, cy], last] = self.camera_matrix;
        if skew != 0.0 || zero != 0.0 || last != [0.0, 0.0, 1.0] {
            return Err(Error::CameraMatrix { camera: self.name });
        }
        let coefficients = &self.distortion_coefficients;
        let Some(distortion) = Distortion::from_coefficients(coefficients) else {
            let found = coefficients.len();
            return Err(Error::DistortionCount { camera: self.name, found });
        };
        let (width, height) = (self.width, self.height);
        let (cx, cy) = (cx + 0.5, cy + 0.5);
        let rotation = DMat3::from_cols_array_2d(&self.rotation).transpose();
        let camera = Camera {
            name: self.name,
            intrinsics: Intrinsics { width, height, fx, fy, cx, cy, lens: distortion.into() },
            extrinsics: Extrinsics { rotation, translation: self.translation * unit_mm },
        };
        camera.validate()?;
        Ok(camera)
    }
}
