//! Rig files: TOML in millimetres and pixels.

use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::camera::Camera;
use crate::error::{Error, Result};
use crate::extrinsics::Extrinsics;
use crate::intrinsics::Intrinsics;
use crate::lens::{Distortion, Fisheye, Lens};
use crate::rig::Rig;
use crate::volume::Volume;

const HEADER: &str = "\
# Lengths in mm. Pixel centres are at integer + 0.5: an image spans 0 to width and 0 to height,
# so add 0.5 to OpenCV's principal point. Camera axes as in OpenCV: x right, y down, z forward,
# x_cam = rotation * x_world + translation_mm; distortion is OpenCV's: k1, k2, p1, p2, k3, and where
# needed k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y; with lens = \"fisheye\", k1, k2, k3, k4.

";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RigFile {
    volume: VolumeFile,
    #[serde(default)]
    camera: Vec<CameraFile>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct VolumeFile {
    center_mm: DVec3,
    size_mm: DVec3,
    forearm: DVec3,
    up: DVec3,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraFile {
    name: String,
    width: u32,
    height: u32,
    focal_px: Focal,
    principal_point_px: Option<DVec2>,
    lens: Option<LensModel>,
    distortion: Option<Vec<f64>>,
    position_mm: Option<DVec3>,
    look_at_mm: Option<DVec3>,
    up: Option<DVec3>,
    /// Row by row.
    rotation: Option<[[f64; 3]; 3]>,
    translation_mm: Option<DVec3>,
}

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Focal {
    Same(f64),
    Each([f64; 2]),
}

#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum LensModel {
    Perspective,
    Fisheye,
}

impl Rig {
    /// Reads and validates a rig file.
    ///
    /// A `[volume]` has `center_mm`, `size_mm`, `forearm` and `up`. Each `[[camera]]` has
    /// `name`, `width`, `height`, `focal_px` (a number or `[fx, fy]`), optionally
    /// `principal_point_px` (default: the middle), `lens` (`"perspective"`, or `"fisheye"`) and
    /// `distortion` (OpenCV's 4, 5, 8, 12 or 14 coefficients, or a fisheye's 4), and either `position_mm`, `look_at_mm` and `up`, or `rotation` (three rows) and
    /// `translation_mm`. Pixel centres are at integer + 0.5.
    pub fn from_toml(text: &str) -> Result<Self> {
        let file: RigFile = toml::from_str(text).map_err(|error| toml_error(text, &error))?;
        let VolumeFile { center_mm: center, size_mm: size, forearm, up } = file.volume;
        let cameras = file.camera.into_iter().map(CameraFile::into_camera);
        let rig = Self {
            cameras: cameras.collect::<Result<_>>()?,
            volume: Volume { center, size, forearm, up },
        };
        rig.validate()?;
        Ok(rig)
    }

    /// Validates the rig and writes it as a rig file, which reads back as exactly this rig.
    pub fn to_toml(&self) -> Result<String> {
        self.validate()?;
        let Volume { center: center_mm, size: size_mm, forearm, up } = self.volume;
        let file = RigFile {
            volume: VolumeFile { center_mm, size_mm, forearm, up },
            camera: self.cameras.iter().map(CameraFile::from_camera).collect(),
        };
        let body = toml::to_string(&file).map_err(|e| Error::Toml { message: e.to_string() })?;
        Ok(HEADER.to_owned() + &body)
    }
}

/// The parser's words and the line, without the line's text, which may be long.
fn toml_error(text: &str, error: &toml::de::Error) -> Error {
    let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
    let line = 1 + before.matches('\n').count();
    Error::Toml { message: format!("line {line}: {}", error.message()) }
}

impl CameraFile {
    fn into_camera(self) -> Result<Camera> {
        let [fx, fy] = match self.focal_px {
            Focal::Same(f) => [f, f],
            Focal::Each(each) => each,
        };
        let middle = DVec2::new(f64::from(self.width), f64::from(self.height)) / 2.0;
        let c = self.principal_point_px.unwrap_or(middle);
        let lens = lens(&self.name, self.lens, &self.distortion.unwrap_or_default())?;
        let intrinsics =
            Intrinsics { width: self.width, height: self.height, fx, fy, cx: c.x, cy: c.y, lens };
        let looking = (self.position_mm, self.look_at_mm, self.up);
        match (looking, (self.rotation, self.translation_mm)) {
            ((Some(position), Some(target), Some(up)), (None, None)) => {
                Camera::look_at(self.name, intrinsics, position, target, up)
            }
            ((None, None, None), (Some(rows), Some(translation))) => {
                let rotation = DMat3::from_cols_array_2d(&rows).transpose();
                let extrinsics = Extrinsics { rotation, translation };
                Ok(Camera { name: self.name, intrinsics, extrinsics })
            }
            _ => Err(Error::Pose { camera: self.name }),
        }
    }

    fn from_camera(camera: &Camera) -> Self {
        let Intrinsics { width, height, fx, fy, cx, cy, lens } = camera.intrinsics;
        Self {
            name: camera.name.clone(),
            width,
            height,
            focal_px: if fx == fy { Focal::Same(fx) } else { Focal::Each([fx, fy]) },
            principal_point_px: Some(DVec2::new(cx, cy)),
            lens: matches!(lens, Lens::Fisheye(_)).then_some(LensModel::Fisheye),
            distortion: (!lens.is_perfect()).then(|| lens.coefficients()),
            position_mm: None,
            look_at_mm: None,
            up: None,
            rotation: Some(camera.extrinsics.rotation.transpose().to_cols_array_2d()),
            translation_mm: Some(camera.extrinsics.translation),
        }
    }
}

/// The lens of these coefficients.
fn lens(camera: &str, model: Option<LensModel>, coefficients: &[f64]) -> Result<Lens> {
    let lens = match model.unwrap_or(LensModel::Perspective) {
        LensModel::Perspective => Distortion::from_coefficients(coefficients).map(Lens::from),
        LensModel::Fisheye => Fisheye::from_coefficients(coefficients).map(Lens::from),
    };
    let found = coefficients.len();
    lens.ok_or_else(|| Error::DistortionCount { camera: camera.to_owned(), found })
}
