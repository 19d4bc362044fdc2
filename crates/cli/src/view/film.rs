//! Overlays as a sheet of frames, or as a video.

use std::io::Write;
use std::process::{Child, Command, Stdio};

use anyhow::{Context, Result, ensure};
use image::{RgbImage, imageops};
use phalanx_cli::files::Output;
use phalanx_io::export::frame_rate;
use phalanx_io::take::Take;

use super::footage::Filmed;
use super::overlay::drawn;
use crate::take_file;

/// So many frames are on a sheet unless it is said otherwise.
const ON_SHEET: usize = 12;

/// A larger sheet is opened by few programs, px.
const MOST_PIXELS: u64 = 64 << 20;

/// Every `every`-th frame from top to bottom, cameras from left to right; evenly spread ones by default.
pub(super) fn sheet(take: &Take, filmed: &mut [Filmed], every: Option<usize>) -> Result<RgbImage> {
    let every = every.unwrap_or_else(|| take.frames.len().div_ceil(ON_SHEET).max(1));
    let rows = take.frames.len().div_ceil(every) as u32;
    let mut sheet = RgbImage::default();
    for (row, frame) in (0..).zip(take.frames.iter().step_by(every)) {
        let drawn = drawn(take, frame, filmed)?;
        let (width, height) = drawn.dimensions();
        if row == 0 {
            let pixels = u64::from(width) * u64::from(height) * u64::from(rows);
            ensure!(pixels <= MOST_PIXELS, "{rows} frames make too large a sheet; see --every");
            sheet = RgbImage::new(width, height * rows);
        }
        imageops::replace(&mut sheet, &drawn, 0, i64::from(row * height));
    }
    ensure!(!sheet.is_empty(), "the take has no frame");
    Ok(sheet)
}

/// Every `every`-th frame as a video that `ffmpeg` encodes.
///
/// # Errors
/// No `ffmpeg`, or what it says.
pub(super) fn video(take: &Take, filmed: &mut [Filmed], every: usize, out: &Output) -> Result<()> {
    // Beside the output, which is replaced once all is there.
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("video").with_extension(take_file::extension(out.path()));
    let rate = frame_rate(take) / every as f64;
    let mut encoder: Option<Child> = None;
    for frame in take.frames.iter().step_by(every) {
        let picture = drawn(take, frame, filmed)?;
        if encoder.is_none() {
            let (width, height) = picture.dimensions();
            let child = Command::new("ffmpeg")
                .args(["-v", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s"])
                .arg(format!("{width}x{height}"))
                .args(["-r", &rate.to_string(), "-i", "-", "-pix_fmt", "yuv420p"])
                .arg(&file)
                .stdin(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn();
            encoder = Some(child.context(
                "a video needs ffmpeg, which does not start here; `--out FILE.png` makes a sheet without it",
            )?);
        }
        let input = encoder.as_mut().and_then(|child| child.stdin.as_mut());
        // What went wrong it says itself, below.
        if input.context("ffmpeg has an input")?.write_all(picture.as_raw()).is_err() {
            break;
        }
    }
    let done = encoder.context("the take has no frame")?.wait_with_output()?;
    let said = String::from_utf8_lossy(&done.stderr);
    ensure!(done.status.success(), "ffmpeg: {}", said.lines().next().unwrap_or("it failed"));
    out.write(&std::fs::read(file)?)
}
