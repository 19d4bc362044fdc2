//! Any video that `ffmpeg` reads, where it is on the path.

use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

use anyhow::{Context, Result, bail, ensure};
use image::{DynamicImage, RgbImage};

use super::{Recording, Stamp};

/// The most pixels that a frame may have.
const MOST_PIXELS: u64 = 64 << 20;

/// A video that a process of `ffmpeg` decodes, frame after frame.
pub(super) struct FfmpegVideo {
    path: PathBuf,
    size: (u32, u32),
    stamps: Vec<Stamp>,
    process: Option<(Child, ChildStdout)>,
    next: usize,
}

impl FfmpegVideo {
    pub(super) fn open(path: &Path) -> Result<Self> {
        let size = probe(path, &["-show_entries", "stream=width,height"])?;
        let size: Vec<u32> = size.trim().split(',').filter_map(|cell| cell.parse().ok()).collect();
        let &[width, height] = size.as_slice() else { bail!("it holds no video") };
        let pixels = u64::from(width) * u64::from(height);
        ensure!(pixels > 0 && pixels <= MOST_PIXELS, "its frames have {width}×{height} px");
        let times = probe(path, &["-show_entries", "packet=pts_time"])?;
        let mut times: Vec<f64> = times
            .lines()
            .filter_map(|line| line.trim_end_matches(',').trim().parse().ok())
            .filter(|time: &f64| time.is_finite())
            .collect();
        times.sort_by(f64::total_cmp);
        let stamp = |(k, time)| Stamp { name: format!("{k}"), time: Some(time) };
        let stamps = times.into_iter().enumerate().map(stamp).collect();
        let path = path.to_owned();
        Ok(Self { path, size: (width, height), stamps, process: None, next: 0 })
    }

    /// The process's output, from its start on.
    fn output(&mut self) -> Result<&mut ChildStdout> {
        if self.process.is_none() {
            let mut child = Command::new("ffmpeg")
                .args(["-nostdin", "-v", "error", "-noautorotate", "-i"])
                .arg(&self.path)
                .args(["-map", "0:v:0", "-fps_mode", "passthrough"])
                .args(["-f", "rawvideo", "-pix_fmt", "rgb24", "-"])
                .stdin(Stdio::null())
                .stdout(Stdio::piped())
                .spawn()
                .map_err(absent)?;
            let output = child.stdout.take().context("ffmpeg has no output")?;
            self.process = Some((child, output));
        }
        Ok(&mut self.process.as_mut().context("ffmpeg was started")?.1)
    }
}

impl Recording for FfmpegVideo {
    fn stamps(&self) -> &[Stamp] {
        &self.stamps
    }

    fn read(&mut self, frame: usize) -> Result<DynamicImage> {
        let (width, height) = self.size;
        let mut pixels = vec![0; width as usize * height as usize * 3];
        ensure!(frame >= self.next, "frames are read in order");
        while self.next <= frame {
            let read = self.output()?.read_exact(&mut pixels);
            read.with_context(|| format!("ffmpeg ends before frame {frame}"))?;
            self.next += 1;
        }
        let picture = RgbImage::from_raw(width, height, pixels).context("a frame is incomplete")?;
        Ok(DynamicImage::ImageRgb8(picture))
    }
}

impl Drop for FfmpegVideo {
    fn drop(&mut self) {
        if let Some((mut child, _)) = self.process.take() {
            // It may have ended by itself; either way nothing remains to be done.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// What `ffprobe` says of the first video stream, a line for each item.
fn probe(path: &Path, entries: &[&str]) -> Result<String> {
    let output = Command::new("ffprobe")
        .args(["-v", "error", "-select_streams", "v:0"])
        .args(entries)
        .args(["-of", "csv=p=0"])
        .arg(path)
        .stdin(Stdio::null())
        .output()
        .map_err(absent)?;
    if !output.status.success() {
        let words = String::from_utf8_lossy(&output.stderr);
        bail!("ffprobe: {}", words.lines().next().unwrap_or("it failed").trim());
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn absent(error: std::io::Error) -> anyhow::Error {
    match error.kind() {
        ErrorKind::NotFound => anyhow::anyhow!(
            "ffmpeg is not installed: install it, or convert the video to H.264 in MP4"
        ),
        _ => anyhow::Error::new(error).context("starting ffmpeg"),
    }
}
