//! The recordings of a rig's cameras, as they are named on the command line.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use phalanx_camera::{Camera, Rig};

use super::assign::assign;
use super::reader::Reader;
use super::timestamps;
use crate::segment::{Pictures, SegmentArguments};

#[derive(Args, Default)]
pub(crate) struct RecordingArguments {
    /// One recording per camera, in the order of the rig or as CAMERA=PATH: a folder of pictures, one a
    /// frame, or a video. One folder that holds them all, named like the cameras, will do.
    #[arg(required = true, value_name = "RECORDING")]
    pub(crate) recordings: Vec<String>,
    #[command(flatten)]
    pub(crate) segment: SegmentArguments,
    /// When the frames were taken: CSV with the columns cam_id and frame_time, s.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) timestamps: Option<PathBuf>,
}

/// Cameras with their recordings, which can be read more than once.
pub(crate) struct Source {
    pub(crate) cameras: Vec<Camera>,
    paths: Vec<PathBuf>,
    /// The cameras' frame times, where they were written apart, and where.
    times: Vec<Option<Vec<f64>>>,
    times_path: Option<PathBuf>,
    pictures: Pictures,
}

impl Source {
    /// Those of a rig's cameras that have a recording; which have none is said on standard error.
    ///
    /// # Errors
    /// Recordings that are no camera's, a timestamps file that lacks a camera.
    pub(crate) fn new(rig: &Rig, arguments: &RecordingArguments) -> Result<Self> {
        let assigned = assign(&rig.cameras, &arguments.recordings)?;
        for (camera, _) in rig.cameras.iter().zip(&assigned).filter(|(_, path)| path.is_none()) {
            eprintln!("phalanx: camera '{}' has no recording and is left out", camera.name);
        }
        let both = rig.cameras.iter().zip(assigned);
        let (cameras, paths): (Vec<Camera>, Vec<PathBuf>) =
            both.filter_map(|(camera, path)| Some((camera.clone(), path?))).unzip();
        let times = times(arguments.timestamps.as_ref(), &cameras)?;
        let pictures = arguments.segment.pictures()?;
        let times_path = arguments.timestamps.clone();
        Ok(Self { cameras, paths, times, times_path, pictures })
    }

    /// Opens the recordings at their beginning.
    ///
    /// # Errors
    /// As of [`Reader::open`].
    pub(crate) fn reader(&self) -> Result<Reader<'_>> {
        Reader::open(&self.cameras, &self.paths, &self.times, &self.pictures)
    }

    /// Each camera's recording.
    pub(crate) fn recordings(&self) -> impl Iterator<Item = (&Camera, &PathBuf)> {
        self.cameras.iter().zip(&self.paths)
    }

    /// The files and folders that are read.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = &PathBuf> {
        self.paths.iter().chain(&self.times_path)
    }
}

fn times(path: Option<&PathBuf>, cameras: &[Camera]) -> Result<Vec<Option<Vec<f64>>>> {
    let Some(path) = path else { return Ok(vec![None; cameras.len()]) };
    let mut all = timestamps::read(path)?;
    let of = |camera: &Camera| {
        let times = all.remove(&camera.name);
        let times = times.with_context(|| {
            format!("{}: there are no times of camera '{}'", path.display(), camera.name)
        })?;
        Ok(Some(times))
    };
    cameras.iter().map(of).collect()
}
