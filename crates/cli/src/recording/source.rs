//! The recordings of a rig's cameras, as they are named on the command line.

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::Args;
use phalanx_camera::{Camera, Rig};
use phalanx_hand::Side;
use phalanx_io::landmarks::LandmarkTrack;

use super::assign::assign;
use super::reader::Reader;
use super::{landmarks, scene, timestamps};
use crate::segment::{Pictures, SegmentArguments};

#[derive(Args, Default)]
pub(crate) struct RecordingArguments {
    /// One recording per camera, in the order of the rig or as CAMERA=PATH: a folder of pictures, one a
    /// frame, or a video. One folder that holds them all, named like the cameras, will do.
    #[arg(required_unless_present = "landmarks", value_name = "RECORDING")]
    pub(crate) recordings: Vec<String>,
    /// What a detector saw of the hand, with or without recordings: one file per camera, in the order of the
    /// rig or as CAMERA=PATH, of MediaPipe (JSON), DeepLabCut or Anipose (CSV), NumPy (NPY) or a plain table
    /// (CSV), a folder of OpenPose's files, or one file of all cameras.
    #[arg(long, value_name = "PATH")]
    pub(crate) landmarks: Vec<String>,
    #[command(flatten)]
    pub(crate) segment: SegmentArguments,
    /// When the frames were taken: CSV with the columns cam_id and frame_time, s.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) timestamps: Option<PathBuf>,
}

/// Cameras with their recordings, which can be read more than once.
pub(crate) struct Source {
    pub(crate) cameras: Vec<Camera>,
    paths: Vec<Option<PathBuf>>,
    /// What a detector saw, camera by camera, and where it was read.
    landmarks: Vec<Option<LandmarkTrack>>,
    landmark_paths: Vec<PathBuf>,
    /// The cameras' frame times, where they were written apart, and where.
    times: Vec<Option<Vec<f64>>>,
    times_path: Option<PathBuf>,
    pictures: Pictures,
}

impl Source {
    /// Those of a rig's cameras that have a recording, or landmarks of the hand of a side; which have none is
    /// said on standard error.
    ///
    /// # Errors
    /// Recordings or landmarks that are no camera's, a timestamps file that lacks a camera.
    pub(crate) fn new(rig: &Rig, arguments: &RecordingArguments, side: Side) -> Result<Self> {
        let assigned = match &*arguments.recordings {
            [] => vec![None; rig.cameras.len()],
            recordings => assign(&rig.cameras, recordings, "recordings")?,
        };
        let tracks = landmarks::read(&rig.cameras, &arguments.landmarks, side)?;
        let (mut cameras, mut paths, mut landmarks) = (Vec::new(), Vec::new(), Vec::new());
        for ((camera, path), track) in rig.cameras.iter().zip(assigned).zip(tracks) {
            if path.is_none() && track.is_none() {
                eprintln!("phalanx: camera '{}' has no recording and is left out", camera.name);
                continue;
            }
            cameras.push(camera.clone());
            paths.push(path);
            landmarks.push(track);
        }
        let times = timestamps::of_cameras(arguments.timestamps.as_deref(), &cameras)?;
        let path = |given: &String| {
            let named = given.split_once('=').filter(|_| !Path::new(given).exists());
            PathBuf::from(named.map_or(given.as_str(), |(_, path)| path))
        };
        let landmark_paths = arguments.landmarks.iter().map(path).collect();
        let mut pictures = arguments.segment.pictures()?;
        if let Pictures::Photographs(_, scenes) = &mut pictures
            && arguments.segment.segment.is_none()
        {
            let recordings = cameras.iter().zip(&paths);
            let recordings =
                recordings.filter_map(|(camera, path)| Some((camera, path.as_deref()?)));
            *scenes = scene::learn(recordings);
        }
        let times_path = arguments.timestamps.clone();
        Ok(Self { cameras, paths, landmarks, landmark_paths, times, times_path, pictures })
    }

    /// Opens the recordings at their beginning.
    ///
    /// # Errors
    /// As of [`Reader::open`].
    pub(crate) fn reader(&self) -> Result<Reader<'_>> {
        let Self { cameras, paths, landmarks, times, pictures, .. } = self;
        Reader::open(cameras, (paths, landmarks), times, pictures)
    }

    /// The recording of each camera that has one.
    pub(crate) fn recordings(&self) -> impl Iterator<Item = (&Camera, &PathBuf)> {
        let both = self.cameras.iter().zip(&self.paths);
        both.filter_map(|(camera, path)| Some((camera, path.as_ref()?)))
    }

    /// What to do where its pictures show no hand.
    pub(crate) fn advice(&self) -> &'static str {
        match self.pictures {
            Pictures::Masks => {
                "look at the masks: the hand and its arm are white, all else is black"
            }
            Pictures::Photographs(..) => "look at the light, or give masks",
        }
    }

    /// The files and folders of landmarks.
    pub(crate) fn landmark_paths(&self) -> &[PathBuf] {
        &self.landmark_paths
    }

    /// The files and folders that are read.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = &PathBuf> {
        self.paths.iter().flatten().chain(&self.times_path).chain(&self.landmark_paths)
    }
}
