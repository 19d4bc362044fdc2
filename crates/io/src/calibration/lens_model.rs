//! Lens models by the names that tools give them.

use phalanx_camera::{Distortion, Fisheye, Lens};

use crate::error::{Error, Result};

/// Which lens model a file names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LensModel {
    Perspective,
    Fisheye,
}

const PERSPECTIVE: [&str; 21] = [
    "pinhole",
    "perspective",
    "standard",
    "opencv",
    "fullopencv",
    "brown",
    "brownconrady",
    "radtan",
    "radialtangential",
    "plumbbob",
    "rational",
    "rationalpolynomial",
    "thinprism",
    "tilted",
    "simplepinhole",
    "linear",
    "none",
    "normal",
    "regular",
    "default",
    "full",
];

const FISHEYE: [&str; 10] = [
    "fisheye",
    "opencvfisheye",
    "equidistant",
    "equi",
    "kannalabrandt",
    "kannalabrandt4",
    "kb",
    "kb4",
    "pinholeequi",
    "ftheta",
];

/// The letters and digits of a name, in lower case.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Whether a name is that of the fisheye model.
pub(super) fn is_fisheye(name: &str) -> bool {
    FISHEYE.contains(&plain(name).as_str())
}

impl LensModel {
    /// The model of this name.
    pub(super) fn named(camera: &str, field: &str, name: &str) -> Result<Self> {
        if is_fisheye(name) {
            Ok(Self::Fisheye)
        } else if PERSPECTIVE.contains(&plain(name).as_str()) {
            Ok(Self::Perspective)
        } else {
            let what = format!(
                "`{name}` is a lens model that is not known: calibrate with OpenCV's pinhole (radtan, \
                 rational) or fisheye (equidistant, Kannala-Brandt) model"
            );
            Err(Error::field(camera, field, what))
        }
    }

    /// The lens of these coefficients.
    pub(super) fn lens(self, camera: &str, coefficients: &[f64]) -> Result<Lens> {
        if !coefficients.iter().all(|k| k.is_finite()) {
            return Err(Error::field(camera, "distortion", "is not finite"));
        }
        let lens = match self {
            Self::Perspective => Distortion::from_coefficients(coefficients).map(Lens::from),
            Self::Fisheye => {
                // Some tools keep room for a fifth.
                let used = coefficients.iter().rposition(|&k| k != 0.0).map_or(0, |last| last + 1);
                let count = coefficients.len().min(4.max(used));
                Fisheye::from_coefficients(&coefficients[..count]).map(Lens::from)
            }
        };
        let found = coefficients.len();
        lens.ok_or_else(|| {
            phalanx_camera::Error::DistortionCount { camera: camera.to_owned(), found }.into()
        })
    }
}
