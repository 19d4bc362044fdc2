//! A take: synchronised pictures of a hand by calibrated cameras, in a folder.
//!
//! ```text
//! calibration.json    the cameras, OpenCV's conventions
//! take.json           {"unit_mm": what a length of 1 in the calibration is, "side": "right"}
//! <camera>/ or colour/<camera>/, grey/<camera>/, masks/<camera>/    a picture a frame
//! ```
//!
//! The references beside them are read by [`Reference`](super::reference::Reference).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use image::DynamicImage;
use phalanx::decode_picture;
use phalanx_camera::Camera;
use phalanx_hand::Side;
use phalanx_io::calibration::{Calibration, Missing, Source, Unit};
use serde::Deserialize;

use super::frame::FrameName;

/// The most memory that decoding a picture may take, bytes.
const MOST_MEMORY: u64 = 1 << 30;
/// What is read as a picture.
const EXTENSIONS: [&str; 6] = ["png", "jpg", "jpeg", "pgm", "ppm", "pnm"];

/// What a method is given to look at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Input {
    /// Masks: hand and arm are white.
    Masks,
    /// Colour photographs.
    Photographs,
    /// A detector's landmarks.
    Landmarks,
    /// Masks, and a detector's landmarks.
    #[value(name = "masks+landmarks")]
    MasksAndLandmarks,
}

impl Input {
    /// All of them.
    pub const ALL: [Self; 4] =
        [Self::Masks, Self::Photographs, Self::Landmarks, Self::MasksAndLandmarks];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Masks => "masks",
            Self::Photographs => "photographs",
            Self::Landmarks => "landmarks",
            Self::MasksAndLandmarks => "masks+landmarks",
        }
    }

    /// Whether landmarks are looked at.
    pub fn has_landmarks(self) -> bool {
        matches!(self, Self::Landmarks | Self::MasksAndLandmarks)
    }
}

/// The pictures of one camera by frame.
type Pictures = BTreeMap<FrameName, PathBuf>;

/// A camera of a take, and where its pictures are.
#[derive(Debug, Clone)]
pub struct TakeCamera {
    /// The camera.
    pub camera: Camera,
    masks: Pictures,
    colour: Pictures,
    grey: Pictures,
}

/// A take.
#[derive(Debug, Clone)]
pub struct Take {
    /// The folder's name.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// Which hand is seen.
    pub side: Side,
    /// In the calibration's order.
    pub cameras: Vec<TakeCamera>,
}

/// What `take.json` says.
#[derive(Deserialize)]
struct Facts {
    unit_mm: f64,
    #[serde(default)]
    side: TakeSide,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "lowercase")]
enum TakeSide {
    #[default]
    Right,
    Left,
}

impl Take {
    /// Reads what is in a take's folder; the pictures themselves when they are looked at.
    ///
    /// # Errors
    /// A calibration or `take.json` that is missing or says something else than expected, and two pictures
    /// of one camera for the same frame; each names the file.
    pub fn read(folder: &Path) -> Result<Self> {
        let text = |name: &str| {
            let path = folder.join(name);
            let text =
                std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
            Ok::<_, anyhow::Error>((path, text))
        };
        let (path, facts) = text("take.json")?;
        let facts: Facts =
            serde_json::from_str(&facts).with_context(|| path.display().to_string())?;
        let (path, calibration) = text("calibration.json")?;
        let file = Source { name: "calibration.json", bytes: calibration.as_bytes() };
        let missing = Missing { unit: Some(Unit::of_mm(facts.unit_mm)?), size: None };
        let calibration =
            Calibration::read(&[file], &missing).with_context(|| path.display().to_string())?;
        let cameras =
            calibration.cameras.into_iter().map(|camera| TakeCamera::read(folder, camera));
        let name = folder.file_name().context("a take's folder has a name")?;
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            folder: folder.to_owned(),
            side: match facts.side {
                TakeSide::Right => Side::Right,
                TakeSide::Left => Side::Left,
            },
            cameras: cameras.collect::<Result<_>>()?,
        })
    }

    /// The cameras of these numbers.
    pub fn cameras(&self, views: &[usize]) -> Vec<Camera> {
        views.iter().map(|&view| self.cameras[view].camera.clone()).collect()
    }

    /// The names of all cameras.
    pub fn camera_names(&self) -> Vec<&str> {
        self.cameras.iter().map(|camera| camera.camera.name.as_str()).collect()
    }

    /// The frames of which each of these cameras has a picture, in order.
    pub fn frames(&self, views: &[usize], input: Input) -> Vec<FrameName> {
        let Some((&first, others)) = views.split_first() else { return Vec::new() };
        let has = |frame: &&FrameName| {
            others.iter().all(|&view| self.cameras[view].pictures(input).contains_key(*frame))
        };
        self.cameras[first].pictures(input).keys().filter(has).cloned().collect()
    }
}

impl TakeCamera {
    fn read(folder: &Path, camera: Camera) -> Result<Self> {
        let pictures = |of: &str| pictures(&folder.join(of).join(&camera.name));
        let colour = match pictures("colour")? {
            colour if colour.is_empty() => pictures("")?,
            colour => colour,
        };
        let (masks, grey) = (pictures("masks")?, pictures("grey")?);
        Ok(Self { camera, masks, colour, grey })
    }

    /// The pictures of an input; landmarks are of photographs.
    fn pictures(&self, input: Input) -> &Pictures {
        match input {
            Input::Masks | Input::MasksAndLandmarks => &self.masks,
            Input::Photographs | Input::Landmarks => &self.colour,
        }
    }

    /// The picture of a frame.
    ///
    /// # Errors
    /// A frame that it has no picture of, a file that cannot be decoded, or a picture of another size
    /// than the camera's.
    pub fn picture(&self, frame: &FrameName, input: Input) -> Result<DynamicImage> {
        let path = self.pictures(input).get(frame);
        let path = path.with_context(|| format!("{}: no {frame}", self.camera.name))?;
        self.decode(path)
    }

    /// The mask of a frame, if the take has one.
    ///
    /// # Errors
    /// As of [`picture`](Self::picture).
    pub fn mask(&self, frame: &FrameName) -> Result<Option<DynamicImage>> {
        self.masks.get(frame).map(|path| self.decode(path)).transpose()
    }

    /// What shows a frame best to people: in colour, else grey, else its mask.
    ///
    /// # Errors
    /// As of [`picture`](Self::picture).
    pub fn shown(&self, frame: &FrameName) -> Result<Option<DynamicImage>> {
        let path = [&self.colour, &self.grey, &self.masks].into_iter().find_map(|p| p.get(frame));
        path.map(|path| self.decode(path)).transpose()
    }

    /// The photograph of a frame, in colour or else grey, if the take has one.
    ///
    /// # Errors
    /// As of [`picture`](Self::picture).
    pub fn in_colour_or_grey(&self, frame: &FrameName) -> Result<Option<DynamicImage>> {
        let path = self.colour.get(frame).or_else(|| self.grey.get(frame));
        path.map(|path| self.decode(path)).transpose()
    }

    /// The photograph of a frame in colour, if the take has one.
    ///
    /// # Errors
    /// As of [`picture`](Self::picture).
    pub fn photograph(&self, frame: &FrameName) -> Result<Option<DynamicImage>> {
        self.colour.get(frame).map(|path| self.decode(path)).transpose()
    }

    fn decode(&self, path: &Path) -> Result<DynamicImage> {
        let decode = || {
            let image = decode_picture(&std::fs::read(path)?, MOST_MEMORY)?;
            let inside = &self.camera.intrinsics;
            let (width, height) = (inside.width, inside.height);
            ensure!(
                (image.width(), image.height()) == (width, height),
                "the picture is {}×{}, the calibration of '{}' says {width}×{height}",
                image.width(),
                image.height(),
                self.camera.name,
            );
            Ok(image)
        };
        decode().with_context(|| path.display().to_string())
    }
}

/// The pictures in a folder by frame; none where there is no such folder.
fn pictures(folder: &Path) -> Result<Pictures> {
    let mut pictures = Pictures::new();
    if !folder.is_dir() {
        return Ok(pictures);
    }
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    for entry in entries {
        let path = entry.with_context(|| folder.display().to_string())?.path();
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let Some(stem) = path.file_stem().filter(|_| EXTENSIONS.contains(&&*extension)) else {
            continue;
        };
        let frame = FrameName::from(&*stem.to_string_lossy());
        if let Some(other) = pictures.insert(frame, path.clone()) {
            bail!("{} and {} are the same frame", path.display(), other.display());
        }
    }
    Ok(pictures)
}

/// The takes in a folder of data, in the order of their names: every folder with a calibration.
///
/// # Errors
/// A folder that cannot be read, or without a take.
pub fn takes_in(data: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(data).with_context(|| data.display().to_string())?;
    let mut folders = Vec::new();
    for entry in entries {
        folders.push(entry.with_context(|| data.display().to_string())?.path());
    }
    folders.retain(|folder| folder.join("calibration.json").is_file());
    folders.sort();
    ensure!(!folders.is_empty(), "{}: no folder with a calibration.json", data.display());
    Ok(folders)
}

/// The takes of these names in a folder of data, or all if none is named.
///
/// # Errors
/// As of [`takes_in`]; also a name that no take has.
pub fn chosen_in(data: &Path, wanted: &[String]) -> Result<Vec<PathBuf>> {
    let mut folders = takes_in(data)?;
    let name = |folder: &Path| folder.file_name().map(|name| name.to_string_lossy().into_owned());
    for wanted in wanted {
        let is_there = folders.iter().any(|folder| name(folder).as_ref() == Some(wanted));
        ensure!(is_there, "{}: no take '{wanted}'", data.display());
    }
    if !wanted.is_empty() {
        folders.retain(|folder| name(folder).is_some_and(|name| wanted.contains(&name)));
    }
    Ok(folders)
}
