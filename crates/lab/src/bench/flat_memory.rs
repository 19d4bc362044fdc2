//! `cargo xtask flat-memory`: whether a recording takes no more memory to track, the longer it is.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::thread::sleep;
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use crate::files::in_repository;
use crate::memory;

#[derive(Args)]
pub struct Arguments {
    /// The program; by default the one beside this.
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
    /// How many frames the recordings have, ascending.
    #[arg(long, value_delimiter = ',', default_values_t = [500, 2000, 20_000])]
    frames: Vec<usize>,
}

/// Two cameras of the demo's rig.
const CAMERAS: [&str; 2] = ["side", "top"];

/// So many frames tell the hand.
const FITTED: &str = "24";

/// The most bytes that a frame may add: its name and time, and where each camera's picture of it is. A row
/// takes twice as many, a picture of the demo ten times.
const MOST: f64 = 1024.0;

/// Two runs of one recording differ by less, bytes.
const NOISE: f64 = 2.0 * MEBIBYTE;

const MEBIBYTE: f64 = (1 << 20) as f64;

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let beside = std::env::current_exe()?.with_file_name("phalanx");
    let program = arguments.program.as_deref().unwrap_or(&beside);
    let folder = in_repository("target/flat-memory");
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    std::fs::create_dir_all(&folder)?;
    let mut demo = Command::new(program);
    let drawn = demo.args(["demo", "--out", "demo"]).current_dir(&folder).output();
    let drawn = drawn.with_context(|| format!("{} (--program)", program.display()))?;
    ensure!(drawn.status.success(), "the demo: {}", String::from_utf8_lossy(&drawn.stderr));
    println!("| frames | peak memory |\n|--:|--:|");
    let mut peaks = Vec::new();
    for &frames in &arguments.frames {
        repeat(&folder, frames)?;
        let peak = peak(program, &folder)?;
        println!("| {frames} | {:.1} MiB |", peak / MEBIBYTE);
        peaks.push((frames, peak));
    }
    let [(few, first), .., (many, last)] = peaks[..] else { bail!("two recordings are compared") };
    ensure!(few < many, "the numbers of frames must ascend");
    let (more, most) = (last - first, NOISE + MOST * (many - few) as f64);
    let verdict = if more <= most { "flat" } else { "not flat" };
    println!(
        "\n{many} frames take {:.1} MiB more than {few}: {verdict} (at most {:.1} MiB asked for).",
        more / MEBIBYTE,
        most / MEBIBYTE
    );
    Ok(ExitCode::from(u8::from(more > most)))
}

/// Makes a recording of so many frames of the demo's, to and fro; pictures that are the same are one file.
fn repeat(folder: &Path, frames: usize) -> Result<()> {
    let recording = folder.join("recording");
    if recording.exists() {
        std::fs::remove_dir_all(&recording)?;
    }
    for camera in CAMERAS {
        let mut pictures = Vec::new();
        for picture in std::fs::read_dir(folder.join("demo/recording").join(camera))? {
            pictures.push(picture?.path());
        }
        pictures.sort_unstable();
        let there = pictures.iter();
        let back = pictures.iter().rev().skip(1).take(pictures.len().saturating_sub(2));
        let cycle = there.chain(back).cycle();
        std::fs::create_dir_all(recording.join(camera))?;
        for (frame, picture) in (0..frames).zip(cycle) {
            std::fs::hard_link(picture, recording.join(camera).join(format!("{frame:06}.png")))?;
        }
    }
    Ok(())
}

/// The most memory that tracking the recording takes, bytes.
fn peak(program: &Path, folder: &Path) -> Result<f64> {
    let mut track = Command::new(program);
    track.args(["track", "--rig", "demo/rig.toml", "recording", "--mask", "--out", "take.csv"]);
    track.args(["--rate", "10", "--fit-together", FITTED]).current_dir(folder);
    let mut child = track.stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
    let process = child.id().to_string();
    let mut peak = None;
    let status = loop {
        peak = memory::peak_of(&process).max(peak);
        if let Some(status) = child.try_wait()? {
            break status;
        }
        sleep(Duration::from_millis(20));
    };
    ensure!(status.success(), "tracking in {} failed: {status}", folder.display());
    Ok(peak.context("this system does not say how much memory was held")? as f64)
}
