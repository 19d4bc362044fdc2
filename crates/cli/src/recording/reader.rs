//! The masks and landmarks of a recording's moments, one after the other.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::{Result, ensure};
use image::DynamicImage;
use phalanx::{Mask, TakeFrame};
use phalanx_camera::Camera;
use phalanx_hand::Landmarks;
use phalanx_io::landmarks::LandmarkTrack;
use phalanx_sampling::spread_subset;

use super::landmarks::{LandmarkRecording, of_frames};
use super::timeline::{Moment, Timeline};
use super::{Recording, Stamp, check_shape, timestamps};
use crate::segment::Pictures;

/// The rate that is assumed where frames have no times, Hz.
const USUAL_RATE: f64 = 30.0;

/// The seed by which some moments are drawn.
const SUBSET_SEED: u64 = 0;

/// Reads what all cameras recorded.
pub(crate) struct Reader<'a> {
    cameras: &'a [Camera],
    paths: &'a [Option<PathBuf>],
    tracks: &'a [Option<LandmarkTrack>],
    recordings: Vec<Box<dyn Recording>>,
    /// What a detector saw in each camera's frames, of those that have landmarks.
    landmarks: Vec<Option<Vec<Option<Landmarks>>>>,
    pictures: &'a Pictures,
    /// The moments and views of the pictures that could not be read so far.
    unreadable: BTreeSet<(usize, usize)>,
    pub(crate) timeline: Timeline,
    /// When each moment was, s: by the cameras' clocks or, where they have none, by a rate.
    pub(crate) times: Vec<f64>,
    /// That rate, Hz, where the cameras have no clocks.
    pub(crate) rate: Option<f64>,
}

impl<'a> Reader<'a> {
    /// Opens the recordings of cameras, and what a detector saw in them. `times` are the cameras' frame times, where they were written apart.
    ///
    /// # Errors
    /// A recording that cannot be opened, another number of times than frames, landmarks of other frames,
    /// nothing to match frames by.
    pub(crate) fn open(
        cameras: &'a [Camera],
        (paths, tracks): (&'a [Option<PathBuf>], &'a [Option<LandmarkTrack>]),
        times: &[Option<Vec<f64>>],
        pictures: &'a Pictures,
    ) -> Result<Self> {
        let recordings = opened(paths, tracks)?;
        let mut landmarks = Vec::new();
        for ((recording, camera), track) in recordings.iter().zip(cameras).zip(tracks) {
            let of_frames = |track| of_frames(track, recording.stamps(), camera);
            landmarks.push(track.as_ref().map(of_frames).transpose()?);
        }
        let mut stamps: Vec<Cow<'_, [Stamp]>> = Vec::new();
        for ((recording, camera), times) in recordings.iter().zip(cameras).zip(times) {
            stamps.push(timestamps::stamped(recording.stamps(), camera, times.as_deref())?);
        }
        let stamps: Vec<&[Stamp]> = stamps.iter().map(AsRef::as_ref).collect();
        let timeline = Timeline::new(&stamps);
        check_shared(cameras, &stamps, &timeline)?;
        let clock: Option<Vec<f64>> = timeline.moments.iter().map(|moment| moment.time).collect();
        let rate = clock.is_none().then_some(USUAL_RATE);
        let times = clock.unwrap_or_else(|| at_rate(timeline.moments.len(), USUAL_RATE));
        let unreadable = BTreeSet::new();
        Ok(Self {
            cameras,
            paths,
            tracks,
            recordings,
            landmarks,
            pictures,
            unreadable,
            timeline,
            times,
            rate,
        })
    }

    /// The same by another rate, Hz, where the cameras have no clocks.
    pub(crate) fn with_rate(mut self, rate: f64) -> Self {
        if self.rate.is_some() {
            (self.times, self.rate) = (at_rate(self.times.len(), rate), Some(rate));
        }
        self
    }

    /// Goes back to the beginning.
    pub(crate) fn rewind(&mut self) -> Result<()> {
        // Never are two lists of all frames held.
        self.recordings.clear();
        self.recordings = opened(self.paths, self.tracks)?;
        Ok(())
    }

    /// The moments.
    pub(crate) fn moments(&self) -> &[Moment] {
        &self.timeline.moments
    }

    /// Whether each view has a frame at a moment that was read, and it could be read.
    pub(crate) fn shown(&self, moment: usize) -> Vec<bool> {
        let frames = self.timeline.moments[moment].frames.iter().enumerate();
        let is_shown = |(view, frame): (usize, &Option<usize>)| {
            frame.is_some() && !self.unreadable.contains(&(moment, view))
        };
        frames.map(is_shown).collect()
    }

    /// Reads some moments from everywhere in the recording; what cannot be read is noted and missing.
    pub(crate) fn read_some(&mut self, most: usize, failures: &mut Vec<String>) -> Vec<TakeFrame> {
        // Every n-th moment of a motion that repeats itself would show one posture.
        let some = spread_subset(self.moments().len(), most, SUBSET_SEED);
        some.into_iter().map(|moment| self.read_noting(moment, failures)).collect()
    }

    /// Reads a moment that comes after the last one read; what cannot be read is noted and missing.
    pub(crate) fn read_noting(&mut self, moment: usize, failures: &mut Vec<String>) -> TakeFrame {
        let (mut masks, mut landmarks) = (Vec::new(), Vec::new());
        for (view, recording) in self.recordings.iter_mut().enumerate() {
            let Some(frame) = self.timeline.moments[moment].frames[view] else {
                masks.push(None);
                landmarks.push(None);
                continue;
            };
            landmarks.push(self.landmarks[view].as_ref().and_then(|points| points[frame]));
            if self.paths[view].is_none() {
                masks.push(None);
                continue;
            }
            let camera = &self.cameras[view];
            let read = recording.read(frame);
            let mask = read.and_then(|picture| mask(&picture, camera, self.pictures));
            let named = |error| {
                let name = &recording.stamps()[frame].name;
                failures.push(format!("frame {name}, camera {}: {error:#}", camera.name));
                self.unreadable.insert((moment, view));
            };
            masks.push(mask.map_err(named).ok());
        }
        if self.tracks.iter().all(Option::is_none) {
            landmarks.clear();
        }
        TakeFrame { masks, landmarks, seconds: Some(self.times[moment]) }
    }
}

/// The times of so many moments at a rate, Hz.
fn at_rate(count: usize, rate: f64) -> Vec<f64> {
    (0..count).map(|k| k as f64 / rate).collect()
}

/// Refuses a camera all frames of which are of moments that no other has.
fn check_shared(cameras: &[Camera], stamps: &[&[Stamp]], timeline: &Timeline) -> Result<()> {
    for (view, camera) in cameras.iter().enumerate() {
        let is_shared = |moment: &Moment| {
            moment.frames[view].is_some() && moment.frames.iter().flatten().count() > 1
        };
        let other = stamps[usize::from(view == 0).min(cameras.len() - 1)];
        ensure!(
            cameras.len() == 1 || timeline.moments.iter().any(is_shared),
            "no frame of camera '{}' is of a moment that another camera has; its first is '{}', another's '{}': \
             give pictures of one moment the same name in every folder, or a timestamps file",
            camera.name,
            stamps[view].first().map_or("", |stamp| &stamp.name),
            other.first().map_or("", |stamp| &stamp.name)
        );
    }
    Ok(())
}

/// The cameras' recordings; of one that has landmarks alone, these.
fn opened(
    paths: &[Option<PathBuf>],
    tracks: &[Option<LandmarkTrack>],
) -> Result<Vec<Box<dyn Recording>>> {
    let mut recordings: Vec<Option<Box<dyn Recording>>> = paths
        .iter()
        .map(|path| path.as_ref().map(|path| super::open(path)).transpose())
        .collect::<Result<_>>()?;
    let first = recordings.iter().flatten().next();
    let like = first.map_or_else(Vec::new, |recording| recording.stamps().to_vec());
    for (recording, track) in recordings.iter_mut().zip(tracks) {
        if let (None, Some(track)) = (&recording, track) {
            *recording = Some(Box::new(LandmarkRecording::new(track, &like)));
        }
    }
    Ok(recordings.into_iter().flatten().collect())
}

/// The mask of a camera's picture.
fn mask(picture: &DynamicImage, camera: &Camera, pictures: &Pictures) -> Result<Mask> {
    check_shape(picture, camera)?;
    pictures.mask(&camera.name, picture)
}
