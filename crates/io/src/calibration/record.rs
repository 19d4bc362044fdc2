//! What a file says of one camera, and the camera that it makes.

use glam::{DMat3, DVec3};
use phalanx_camera::{Camera, Extrinsics, Intrinsics, Lens};

use crate::calibration::lens_model::LensModel;
use crate::calibration::rotation;
use crate::calibration::unit::Unit;
use crate::error::{Error, Result};

/// The most cameras that are read.
pub(super) const MOST_CAMERAS: usize = 256;

/// A camera as a file has it: lengths in the file's unit, pixels counted from the centre of the first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Record {
    pub(super) name: String,
    /// Width and height, px.
    pub(super) size: Option<[f64; 2]>,
    pub(super) matrix: CameraMatrix,
    pub(super) lens: LensModel,
    /// Of the lens, in OpenCV's order.
    pub(super) coefficients: Vec<f64>,
    pub(super) pose: Pose,
    /// What was noticed while reading it.
    pub(super) notes: Vec<String>,
}

/// Focal lengths and principal point, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CameraMatrix {
    pub(super) fx: f64,
    pub(super) fy: f64,
    pub(super) cx: f64,
    pub(super) cy: f64,
}

/// From the world to the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub(super) rotation: DMat3,
    pub(super) translation: DVec3,
}

impl Pose {
    /// Of a camera that stands at `position` with axes turned by `world_from_camera`.
    pub(super) fn of_camera(world_from_camera: DMat3, position: DVec3) -> Self {
        let rotation = world_from_camera.transpose();
        Self { rotation, translation: -(rotation * position) }
    }

    /// After `first`.
    pub(super) fn after(&self, first: &Self) -> Self {
        Self {
            rotation: self.rotation * first.rotation,
            translation: self.rotation * first.translation + self.translation,
        }
    }
}

/// How far OpenCV's pixel positions are from ours: it counts from the first pixel's centre, we from
/// its corner.
pub(super) const FIRST_CENTRE: f64 = 0.5;

impl Record {
    /// A camera of unknown size with a perfect lens.
    pub(super) fn new(name: String, matrix: CameraMatrix, pose: Pose) -> Self {
        let (lens, coefficients, notes) = (LensModel::Perspective, Vec::new(), Vec::new());
        Self { name, size: None, matrix, lens, coefficients, pose, notes }
    }

    /// What a file would say of a camera, in millimetres.
    pub(super) fn of_camera(camera: Camera) -> Self {
        let Intrinsics { width, height, fx, fy, cx, cy, lens } = camera.intrinsics;
        let Extrinsics { rotation, translation } = camera.extrinsics;
        let (cx, cy) = (cx - FIRST_CENTRE, cy - FIRST_CENTRE);
        let pose = Pose { rotation, translation };
        Self {
            size: Some([f64::from(width), f64::from(height)]),
            lens: match lens {
                Lens::Perspective(_) => LensModel::Perspective,
                Lens::Fisheye(_) => LensModel::Fisheye,
            },
            coefficients: lens.coefficients(),
            ..Self::new(camera.name, CameraMatrix { fx, fy, cx, cy }, pose)
        }
    }

    /// The camera, of pictures of `size` where the file does not say it.
    pub(super) fn into_camera(
        self,
        unit: Unit,
        size: Option<(u32, u32)>,
        notes: &mut Vec<String>,
    ) -> Result<Camera> {
        let name = self.camera_name(notes);
        let (width, height) = self.picture(&name, size)?;
        let lens = self.lens.lens(&name, &self.coefficients)?;
        let CameraMatrix { fx, fy, cx, cy } = self.matrix;
        let (cx, cy) = (cx + FIRST_CENTRE, cy + FIRST_CENTRE);
        let intrinsics = Intrinsics { width, height, fx, fy, cx, cy, lens };
        check_principal_point(&name, &intrinsics)?;
        let (rotation, note) = rotation::nearest(&name, self.pose.rotation)?;
        notes.extend(note);
        for note in self.notes {
            let note = format!("camera `{name}`: {note}");
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
        let translation = self.pose.translation * unit.mm();
        let camera = Camera { name, intrinsics, extrinsics: Extrinsics { rotation, translation } };
        camera.validate()?;
        Ok(camera)
    }

    /// The name, with `_` for blanks: folders of pictures and columns are called by it.
    fn camera_name(&self, notes: &mut Vec<String>) -> String {
        let name: String =
            self.name.trim().chars().map(|c| if c.is_whitespace() { '_' } else { c }).collect();
        if name != self.name {
            notes.push(format!("camera `{}` is called `{name}` from here on", self.name));
        }
        name
    }

    /// Width and height.
    fn picture(&self, name: &str, given: Option<(u32, u32)>) -> Result<(u32, u32)> {
        let Some(size) = self.size else {
            return given.ok_or_else(|| {
                Error::field(
                    name,
                    "size",
                    "is not in the file: give the pictures' width and height",
                )
            });
        };
        let [width, height] = size;
        let whole = |side: f64| {
            (side >= 1.0 && side <= f64::from(u32::MAX) && (side - side.round()).abs() < 1e-6)
                .then_some(side.round() as u32)
        };
        let (Some(w), Some(h)) = (whole(width), whole(height)) else {
            return Err(Error::field(name, "size", format!("{width}×{height} px is no picture's")));
        };
        match given {
            Some((gw, gh)) if (gw, gh) != (w, h) => Err(Error::field(
                name,
                "size",
                format!("is {w}×{h} px in the file and {gw}×{gh} as given"),
            )),
            _ => Ok((w, h)),
        }
    }
}

/// Refuses a picture that does not hold its principal point, as where its sides are swapped.
fn check_principal_point(name: &str, intrinsics: &Intrinsics) -> Result<()> {
    let Intrinsics { width, height, cx, cy, .. } = *intrinsics;
    if intrinsics.contains(intrinsics.principal_point()) || !(cx.is_finite() && cy.is_finite()) {
        return Ok(());
    }
    let turned = Intrinsics { width: height, height: width, ..*intrinsics };
    let hint = if turned.contains(turned.principal_point()) {
        ": are width and height swapped, or is the picture turned?"
    } else {
        ": is the calibration of another size?"
    };
    let what =
        format!("{width}×{height} px does not hold the principal point {cx:.1}, {cy:.1}{hint}");
    Err(Error::field(name, "size", what))
}
