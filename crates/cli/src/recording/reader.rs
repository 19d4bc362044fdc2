//! The masks of a recording's moments, one after the other.

use std::borrow::Cow;
use std::path::PathBuf;

use anyhow::{Result, ensure};
use image::DynamicImage;
use phalanx::{Mask, TakeFrame};
use phalanx_camera::Camera;

use super::timeline::{Moment, Timeline};
use super::{Recording, Stamp};
use crate::segment::Pictures;

/// Reads what all cameras recorded.
pub(crate) struct Reader<'a> {
    cameras: &'a [Camera],
    paths: &'a [PathBuf],
    recordings: Vec<Box<dyn Recording>>,
    pictures: &'a Pictures,
    pub(crate) timeline: Timeline,
}

impl<'a> Reader<'a> {
    /// Opens the recordings of cameras. `times` are the cameras' frame times, where they were written apart.
    ///
    /// # Errors
    /// A recording that cannot be opened, another number of times than frames, nothing to match frames by.
    pub(crate) fn open(
        cameras: &'a [Camera],
        paths: &'a [PathBuf],
        times: &[Option<Vec<f64>>],
        pictures: &'a Pictures,
    ) -> Result<Self> {
        let recordings = opened(paths)?;
        let mut stamps: Vec<Cow<'_, [Stamp]>> = Vec::new();
        for ((recording, camera), times) in recordings.iter().zip(cameras).zip(times) {
            stamps.push(with_times(recording.stamps(), camera, times.as_deref())?);
        }
        let stamps: Vec<&[Stamp]> = stamps.iter().map(AsRef::as_ref).collect();
        let timeline = Timeline::new(&stamps);
        let shared =
            timeline.moments.iter().any(|moment| moment.frames.iter().flatten().count() > 1);
        ensure!(
            cameras.len() == 1 || shared,
            "no two cameras have a frame of one moment: give pictures of one moment the same name in every \
             folder, or a timestamps file"
        );
        Ok(Self { cameras, paths, recordings, pictures, timeline })
    }

    /// Goes back to the beginning.
    pub(crate) fn rewind(&mut self) -> Result<()> {
        // Never are two lists of all frames held.
        self.recordings.clear();
        self.recordings = opened(self.paths)?;
        Ok(())
    }

    /// The moments.
    pub(crate) fn moments(&self) -> &[Moment] {
        &self.timeline.moments
    }

    /// Reads some moments, evenly spread; what cannot be read is noted and missing.
    pub(crate) fn read_some(&mut self, most: usize, failures: &mut Vec<String>) -> Vec<TakeFrame> {
        let count = self.moments().len();
        let some = most.min(count);
        // The middle of each of so many equal parts.
        let middle = |k: usize| (2 * k + 1) * count / (2 * some);
        (0..some).map(|k| self.read_noting(middle(k), failures)).collect()
    }

    /// Reads a moment that comes after the last one read; what cannot be read is noted and missing.
    pub(crate) fn read_noting(&mut self, moment: usize, failures: &mut Vec<String>) -> TakeFrame {
        let mut masks = Vec::new();
        for (view, recording) in self.recordings.iter_mut().enumerate() {
            let Some(frame) = self.timeline.moments[moment].frames[view] else {
                masks.push(None);
                continue;
            };
            let camera = &self.cameras[view];
            let read = recording.read(frame);
            let mask = read.and_then(|picture| mask(&picture, camera, self.pictures));
            let named = |error| {
                let name = &recording.stamps()[frame].name;
                failures.push(format!("frame {name}, camera {}: {error:#}", camera.name));
            };
            masks.push(mask.map_err(named).ok());
        }
        TakeFrame::of_masks(masks)
    }
}

fn opened(paths: &[PathBuf]) -> Result<Vec<Box<dyn Recording>>> {
    paths.iter().map(|path| super::open(path)).collect()
}

fn with_times<'a>(
    stamps: &'a [Stamp],
    camera: &Camera,
    times: Option<&[f64]>,
) -> Result<Cow<'a, [Stamp]>> {
    let Some(times) = times else { return Ok(Cow::Borrowed(stamps)) };
    ensure!(
        times.len() == stamps.len(),
        "camera '{}' has {} frames, but {} times",
        camera.name,
        stamps.len(),
        times.len()
    );
    let with_time = |(stamp, &time): (&Stamp, &f64)| Stamp { time: Some(time), ..stamp.clone() };
    Ok(stamps.iter().zip(times).map(with_time).collect())
}

/// The mask of a picture, which must be a scaled copy of the camera's image to within a pixel.
fn mask(picture: &DynamicImage, camera: &Camera, pictures: &Pictures) -> Result<Mask> {
    let (width, height) = (picture.width(), picture.height());
    let (own_width, own_height) = (camera.intrinsics.width, camera.intrinsics.height);
    let fitting = f64::from(width) * f64::from(own_height) / f64::from(own_width);
    ensure!(
        (fitting - f64::from(height)).abs() <= 1.0,
        "the picture has {width}×{height} px, but the camera was calibrated for {own_width}×{own_height}; \
         is it turned or cropped?"
    );
    pictures.mask(&camera.name, picture)
}
