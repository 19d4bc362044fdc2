//! `cargo xtask flat-memory`: whether a recording takes no more memory to track, the longer it is.

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use anyhow::{Result, bail, ensure};
use clap::Args;

use crate::bench::repeated;
use crate::child::{self, MEBIBYTE};

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

/// Two runs differ by less, whatever their length, bytes: by up to 2.5 MiB either way so far. A recording that was held
/// in memory would differ by 19 MiB in 600 of the demo's frames.
const NOISE: f64 = 4.0 * MEBIBYTE;

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let program = repeated::program(arguments.program.as_deref())?;
    let folder = repeated::drawn(&program, "target/flat-memory")?;
    println!("| frames | peak memory |\n|--:|--:|");
    let mut peaks = Vec::new();
    for &frames in &arguments.frames {
        repeated::recording(&folder, &CAMERAS, frames)?;
        let mut track = Command::new(&program);
        repeated::track(track.current_dir(&folder)).args(["--fit-together", FITTED]);
        let peak = child::run(&mut track)?.peak;
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
