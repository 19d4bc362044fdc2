//! Calibrated cameras, read from the files of other tools and written for them.
//!
//! Files are recognised by what they hold, not by their names:
//!
//! | written by | form |
//! |---|---|
//! | Anipose, aniposelib, FreeMoCap, Caliscope, Pose2Sim | TOML with a section a camera |
//! | OpenCV's `FileStorage`, EasyMocap (`intri.yml` with `extri.yml`) | YAML, XML, JSON |
//! | Kalibr | YAML, a chain of cameras |
//! | ROS | YAML, with a pose beside it |
//! | multical, CMU Panoptic, scripts in Python | JSON, cameras in a list or by name |
//! | COLMAP | text, `cameras.txt` with `images.txt` |
//! | Qualisys (`.qca.txt`), Vicon (`.xcp`) | XML |
//! | bioCV (`.calib`) | text, a file a camera |
//! | phalanx | rig files, JSON with `cameras` |
//!
//! Every camera comes out in phalanx's conventions: millimetres, from the world to the camera, pixel
//! centres at integer + 0.5.

mod biocv;
mod chain;
mod colmap;
mod distance;
mod document;
mod field;
mod fields;
mod files;
mod flat;
mod layout;
mod lens_model;
mod numbers;
mod record;
mod rotation;
mod syntax;
mod unit;
mod value;
mod write;
mod xml;
mod yaml;

use phalanx_camera::{Camera, Volume};

pub use distance::{Distance, camera_distances};
pub use unit::Unit;
pub use write::{to_anipose_toml, to_opencv_yaml};

pub use crate::source::Source;

use crate::calibration::document::Document;
use crate::calibration::record::{MOST_CAMERAS, Record};
use crate::error::{Error, Result};

/// Calibrated cameras, in millimetres and phalanx's conventions.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The cameras, in the file's order.
    pub cameras: Vec<Camera>,
    /// Where the hand works, which only rig files say.
    pub volume: Option<Volume>,
    /// What a length of 1 is in the file.
    pub unit: Unit,
    /// What was taken for granted, changed or left out while reading, a sentence each.
    pub notes: Vec<String>,
}

/// What files may leave open.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Missing {
    /// What a length of 1 is. Most files do not say it; one that does must agree.
    pub unit: Option<Unit>,
    /// Width and height of the pictures, px, for cameras of which the file does not say them.
    pub size: Option<(u32, u32)>,
}

impl Calibration {
    /// Reads a calibration from one file, or from several that complete each other: intrinsics and
    /// extrinsics, or a file a camera.
    ///
    /// # Errors
    /// Text that is no calibration, or one that leaves something open, contradicts itself, or has
    /// cameras nearer than 20 mm or farther than 20 m from each other; each names the camera and the
    /// field, and says what to do.
    ///
    /// ```
    /// use phalanx_io::calibration::{Calibration, Missing, Source, Unit};
    ///
    /// let text = br#"
    /// [cam_0]
    /// name = "left"
    /// size = [640, 480]
    /// matrix = [[600.0, 0.0, 319.5], [0.0, 600.0, 239.5], [0.0, 0.0, 1.0]]
    /// distortions = [0.0, 0.0, 0.0, 0.0, 0.0]
    /// rotation = [0.0, 0.0, 0.0]
    /// translation = [0.0, 0.0, 0.5]
    /// "#;
    /// let file = Source { name: "calibration.toml", bytes: text };
    /// let metres = Missing { unit: Some(Unit::METRE), ..Missing::default() };
    /// let calibration = Calibration::read(&[file], &metres)?;
    /// let left = &calibration.cameras[0];
    /// assert_eq!((left.intrinsics.cx, left.extrinsics.translation.z), (320.0, 500.0));
    /// # Ok::<(), phalanx_io::Error>(())
    /// ```
    pub fn read(files: &[Source<'_>], missing: &Missing) -> Result<Self> {
        let Document { records, volume, unit, hint, mut notes } = files::read(files)?;
        if records.is_empty() {
            return Err(Error::calibration("it holds no camera"));
        }
        if records.len() > MOST_CAMERAS {
            return Err(Error::calibration(format!(
                "{} cameras; at most {MOST_CAMERAS} are read",
                records.len()
            )));
        }
        let unit = unit::agreed(unit, missing.unit, hint)?;
        let read = |record: Record| record.into_camera(unit, missing.size, &mut notes);
        let cameras: Vec<Camera> = records.into_iter().map(read).collect::<Result<_>>()?;
        check_names(&cameras)?;
        distance::check(&cameras)?;
        notes.extend(order_note(&cameras));
        Ok(Self { cameras, volume, unit, notes })
    }
}

fn check_names(cameras: &[Camera]) -> Result<()> {
    for (index, camera) in cameras.iter().enumerate() {
        if cameras[..index].iter().any(|earlier| earlier.name == camera.name) {
            let camera = camera.name.clone();
            return Err(phalanx_camera::Error::DuplicateName { camera }.into());
        }
    }
    Ok(())
}

/// Several tools sort `cam_10` before `cam_2`: said, since pictures are given in the cameras' order.
fn order_note(cameras: &[Camera]) -> Option<String> {
    let number = |camera: &Camera| -> Option<u64> {
        let start = camera.name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        camera.name[start..].parse().ok()
    };
    let numbers: Vec<u64> = cameras.iter().map(number).collect::<Option<_>>()?;
    (!numbers.is_sorted()).then(|| {
        let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
        format!("the cameras stay in the file's order, {}", names.join(", "))
    })
}
