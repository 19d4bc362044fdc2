//! What one camera recorded: a folder of pictures or a video, read frame by frame.

pub(crate) mod agreement;
pub(crate) mod assign;
pub(crate) mod doubt;
mod ffmpeg;
pub(crate) mod landmarks;
mod mp4;
pub(crate) mod pictures;
pub(crate) mod reader;
mod scene;
pub(crate) mod source;
pub(crate) mod timeline;
pub(crate) mod timestamps;
mod yuv;

use std::path::Path;

use anyhow::{Context, Result, ensure};
use image::DynamicImage;
use phalanx_camera::Camera;

/// When a frame was taken.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stamp {
    /// The name of a picture's file without its ending, or the frame's number in a video.
    pub(crate) name: String,
    /// Seconds on the recording's own clock, where it has one.
    pub(crate) time: Option<f64>,
}

/// A recording of one camera. Frames are read in ascending order; those between may be left out.
pub(crate) trait Recording {
    /// All its frames, in order.
    fn stamps(&self) -> &[Stamp];

    /// Reads a frame that comes after the last one read.
    ///
    /// # Errors
    /// A frame that cannot be read or decoded; later ones may still be.
    fn read(&mut self, frame: usize) -> Result<DynamicImage>;
}

/// Opens a folder of pictures or a video file.
///
/// # Errors
/// Nothing there, no frame in it, or a video that neither the program nor `ffmpeg` can read.
pub(crate) fn open(path: &Path) -> Result<Box<dyn Recording>> {
    let name = || path.display().to_string();
    ensure!(path.exists(), "{}: there is no such file or folder", path.display());
    let kind = std::fs::metadata(path).with_context(name)?;
    let recording: Box<dyn Recording> = if kind.is_dir() {
        Box::new(pictures::PictureFolder::open(path).with_context(name)?)
    } else {
        open_video(path).with_context(name)?
    };
    ensure!(!recording.stamps().is_empty(), "{}: there is no frame in it", path.display());
    Ok(recording)
}

/// Refuses a picture that is no scaled copy of its camera's image, to within a pixel.
pub(crate) fn check_shape(picture: &DynamicImage, camera: &Camera) -> Result<()> {
    let (width, height) = (picture.width(), picture.height());
    let (own_width, own_height) = (camera.intrinsics.width, camera.intrinsics.height);
    let fitting = f64::from(width) * f64::from(own_height) / f64::from(own_width);
    ensure!(
        (fitting - f64::from(height)).abs() <= 1.0,
        "the picture has {width}×{height} px, but the camera was calibrated for {own_width}×{own_height}; \
         is it turned or cropped, or another recording's?"
    );
    Ok(())
}

/// H.264 in MP4 is decoded here; `ffmpeg` reads every other video, where it is installed.
fn open_video(path: &Path) -> Result<Box<dyn Recording>> {
    let own = match mp4::Mp4Video::open(path) {
        Ok(video) => return Ok(Box::new(video)),
        Err(error) => error,
    };
    match ffmpeg::FfmpegVideo::open(path) {
        Ok(video) => Ok(Box::new(video)),
        Err(error) => Err(error.context(format!(
            "this is no H.264 video in an MP4 file ({own:#}), and ffmpeg does not read it either"
        ))),
    }
}
