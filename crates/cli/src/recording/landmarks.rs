//! What a detector saw of the hand in each camera's pictures.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use image::DynamicImage;
use phalanx_camera::Camera;
use phalanx_hand::{Landmarks, Side};
use phalanx_io::Source;
use phalanx_io::landmarks::{self, LandmarkTrack, number_in_name};

use super::assign::assign;
use super::{Recording, Stamp};
use crate::counts::counted;
use phalanx_cli::reading;

/// The tracks of a rig's cameras, in its order, in pixels of their images; `None` of a camera without any.
///
/// # Errors
/// A file that cannot be read, and landmarks of no camera or of a camera twice.
pub(crate) fn read(
    cameras: &[Camera],
    given: &[String],
    side: Side,
) -> Result<Vec<Option<LandmarkTrack>>> {
    let tracks = match given {
        [] => return Ok(vec![None; cameras.len()]),
        [path] if Path::new(path).is_file() => of_one_file(cameras, Path::new(path), side)?,
        _ => {
            let assigned = assign(cameras, given, "landmarks")?;
            let of = |path: Option<PathBuf>| path.map(|path| one(&path, side)).transpose();
            assigned.into_iter().map(of).collect::<Result<_>>()?
        }
    };
    let in_pixels = |(camera, track): (&Camera, Option<LandmarkTrack>)| {
        let size = (camera.intrinsics.width, camera.intrinsics.height);
        track.map(|track| track.in_pixels(size))
    };
    Ok(cameras.iter().zip(tracks).map(in_pixels).collect())
}

/// A file that holds all cameras: by their names or, without any, in their order.
fn of_one_file(cameras: &[Camera], path: &Path, side: Side) -> Result<Vec<Option<LandmarkTrack>>> {
    let found = tracks(path, side)?;
    let (place, count) = (path.display(), found.len());
    if found.iter().all(|track| track.camera.is_none()) {
        ensure!(
            count == cameras.len(),
            "{place}: landmarks of {}, where the rig has {}: name the camera, such as {}={place}",
            counted(count, "camera"),
            cameras.len(),
            cameras[0].name
        );
        return Ok(found.into_iter().map(Some).collect());
    }
    let mut of_cameras = vec![None; cameras.len()];
    for track in found {
        let name = track.camera.clone().unwrap_or_default();
        let camera = cameras.iter().position(|camera| camera.name == name);
        let camera = camera.with_context(|| format!("{place}: the rig has no camera '{name}'"))?;
        of_cameras[camera] = Some(track);
    }
    Ok(of_cameras)
}

/// The landmarks of one camera: a file, or a folder with a file for each frame.
fn one(path: &Path, side: Side) -> Result<LandmarkTrack> {
    if !path.is_dir() {
        return only(path, side);
    }
    let entries = std::fs::read_dir(path).with_context(|| path.display().to_string())?;
    let mut files: Vec<PathBuf> =
        entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    files.retain(|file| is_frame(file));
    files.sort();
    let mut all = LandmarkTrack::default();
    for file in &files {
        all.join(only(file, side)?, &name_of(file))?;
    }
    ensure!(!files.is_empty(), "{}: no .json file of a frame is in it", path.display());
    Ok(all)
}

/// Whether a folder's file is of a frame.
pub(crate) fn is_frame(path: &Path) -> bool {
    let is_json = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    is_json && !name_of(path).starts_with('.')
}

/// The one camera of a file.
fn only(path: &Path, side: Side) -> Result<LandmarkTrack> {
    let found = tracks(path, side)?;
    let count = found.len();
    let [track] = <[_; 1]>::try_from(found).map_err(|_| {
        anyhow::anyhow!(
            "{}: it holds landmarks of {}; give it alone, without a camera's name",
            path.display(),
            counted(count, "camera")
        )
    })?;
    Ok(track)
}

fn tracks(path: &Path, side: Side) -> Result<Vec<LandmarkTrack>> {
    let place = || path.display().to_string();
    let bytes = reading::read(path).with_context(place)?;
    landmarks::read(&Source { name: &name_of(path), bytes: &bytes }, side).with_context(place)
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The landmarks of a camera's frames, in their order.
///
/// # Errors
/// Landmarks of other frames than the camera has.
pub(crate) fn of_frames(
    track: &LandmarkTrack,
    stamps: &[Stamp],
    camera: &Camera,
) -> Result<Vec<Option<Landmarks>>> {
    let name = &camera.name;
    if let Some(places) = track.places {
        ensure!(
            places == stamps.len() as u64,
            "camera '{name}' has landmarks of {}, but {}: number them, or give as many",
            counted(places, "frame"),
            counted(stamps.len(), "frame")
        );
        return Ok((0..places).map(|place| track.frames.get(&place).copied()).collect());
    }
    let of = |stamp: &Stamp| track.frames.get(&number_in_name(&stamp.name)?).copied();
    let found: Vec<Option<Landmarks>> = stamps.iter().map(of).collect();
    if let (Some(first), false) = (track.frames.keys().next(), found.iter().any(Option::is_some)) {
        bail!(
            "camera '{name}' has landmarks of frame {first} and others, but no frame of such a number; its \
             first is '{}'",
            stamps.first().map_or("", |stamp| &stamp.name)
        );
    }
    Ok(found)
}

/// The frames of a camera that has landmarks alone.
pub(crate) struct LandmarkRecording(Vec<Stamp>);

impl LandmarkRecording {
    /// Its frames are those of another camera of the same number, with their names and times; without
    /// another, those that have landmarks.
    pub(crate) fn new(track: &LandmarkTrack, like: &[Stamp]) -> Self {
        let numbers = |count: u64| (0..count).map(|number| number.to_string());
        let names: Vec<String> = match track.places {
            Some(count) => numbers(count).collect(),
            None => track.frames.keys().map(u64::to_string).collect(),
        };
        let alone = names.into_iter().map(|name| Stamp { name, time: None });
        match (like, track.places) {
            ([], _) => Self(alone.collect()),
            (like, Some(count)) => Self(like.iter().take(count as usize).cloned().collect()),
            (like, None) => {
                let has = |stamp: &&Stamp| {
                    number_in_name(&stamp.name).is_some_and(|own| track.frames.contains_key(&own))
                };
                Self(like.iter().filter(has).cloned().collect())
            }
        }
    }
}

impl Recording for LandmarkRecording {
    fn stamps(&self) -> &[Stamp] {
        &self.0
    }

    fn read(&mut self, _: usize) -> Result<DynamicImage> {
        bail!("there are landmarks of it, and no picture")
    }
}
