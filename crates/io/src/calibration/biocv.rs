//! bioCV's `.calib`: a file a camera, in millimetres.

use glam::{DMat3, DVec3};

use crate::calibration::numbers;
use crate::calibration::record::{CameraMatrix, Pose, Record};
use crate::error::{Error, Result};

/// Width; height; three rows of the camera matrix; three or four of [R t]; the distortion.
pub(super) fn record(name: &str, text: &str) -> Result<Record> {
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    let rows: Vec<Vec<f64>> =
        lines.map(|line| numbers::of_line(line, name)).collect::<Result<_>>()?;
    let wrong = || Error::calibration(format!("{name}: it is not laid out as bioCV's .calib"));
    let ([w, h, ka, kb, kc, ra, rb, rc, coefficients]
    | [w, h, ka, kb, kc, ra, rb, rc, _, coefficients]) = &rows[..]
    else {
        return Err(wrong());
    };
    match (&w[..], &h[..], [&ka[..], &kb[..], &kc[..]], [&ra[..], &rb[..], &rc[..]]) {
        (
            &[width],
            &[height],
            [&[fx, _, cx], &[_, fy, cy], &[_, _, _]],
            [&[r11, r12, r13, tx], &[r21, r22, r23, ty], &[r31, r32, r33, tz]],
        ) => {
            let rotation =
                DMat3::from_cols_array(&[r11, r12, r13, r21, r22, r23, r31, r32, r33]).transpose();
            let pose = Pose { rotation, translation: DVec3::new(tx, ty, tz) };
            let matrix = CameraMatrix { fx, fy, cx, cy };
            let record = Record::new(name.to_owned(), matrix, pose);
            let coefficients = coefficients.clone();
            Ok(Record { size: Some([width, height]), coefficients, ..record })
        }
        _ => Err(wrong()),
    }
}
