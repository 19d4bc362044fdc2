//! `phalanx track`.

mod cameras;
mod reader;
mod take;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail, ensure};
use clap::{Args, ValueEnum};
use phalanx::{
    FrameFit, Progress, Proportions, TakeFit, TakeFrame, TakeSettings, fit_frame, fit_take,
};
use phalanx_camera::{Camera, Rig};
use phalanx_cli::files::Output;
use phalanx_hand::{HandShape, Side};
use phalanx_io::take::{Take, write_csv, write_json_lines, write_npz};
use rayon::prelude::*;

use self::reader::{Pictures, Reader, Seen};
use crate::progress::Bar;
use crate::recording::timeline::Timeline;
use crate::rig::check;
use crate::{input, recording};

/// Recordings of up to so many moments are fitted as a whole. Of longer ones as many moments, evenly spread,
/// tell the hand, and then every frame is fitted with it, so that memory does not grow with the recording.
const WHOLE: usize = 240;

/// Frames that are fitted at a time, each on its own.
const BLOCK: usize = 32;

/// The rate that is assumed where frames have no times, Hz.
const USUAL_RATE: f64 = 30.0;

#[derive(Args)]
pub(crate) struct Arguments {
    /// One recording per camera, in the order of the rig or as CAMERA=PATH: a folder of pictures, one a
    /// frame, or a video. One folder that holds them all, named like the cameras, will do.
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<String>,
    /// The cameras, as `phalanx rig import` writes them.
    #[arg(long, value_name = "FILE.toml")]
    rig: PathBuf,
    /// The pictures are masks: brighter than 127 is hand.
    #[arg(long)]
    mask: bool,
    /// The person's hand, as `calibrate-hand` or `--save-hand` writes it; fitted on the way by default.
    #[arg(long, value_name = "FILE.toml")]
    hand: Option<PathBuf>,
    /// Which hand it is.
    #[arg(long, value_enum, default_value_t)]
    side: SideName,
    /// When the frames were taken: CSV with the columns cam_id and frame_time, s.
    #[arg(long, value_name = "FILE.csv")]
    timestamps: Option<PathBuf>,
    /// The frame rate of pictures that have no times; 30 Hz by default.
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Where the angles go: .csv, .jsonl or .npz by its name, or - for CSV on standard output.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Write the hand that was fitted, for later recordings of the same person.
    #[arg(long, value_name = "FILE.toml")]
    save_hand: Option<PathBuf>,
}

/// The sides by name.
#[derive(Clone, Copy, Default, ValueEnum)]
enum SideName {
    /// A right hand.
    #[default]
    Right,
    /// A left hand.
    Left,
}

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let kind = kind(&arguments.out)?;
    let rig = check::read(&arguments.rig)?;
    let (cameras, paths) = cameras_and_paths(&rig, &arguments.recordings)?;
    let given = [Some(&arguments.rig), arguments.hand.as_ref(), arguments.timestamps.as_ref()];
    let inputs: Vec<&PathBuf> = paths.iter().chain(given.into_iter().flatten()).collect();
    let out = Output::new(&arguments.out, &inputs)?;
    let hand_out = arguments.save_hand.as_ref().map(|path| Output::new(path, &inputs));
    let hand_out = hand_out.transpose()?;
    let times = times(arguments, &cameras)?;
    let pictures = if arguments.mask { Pictures::Masks } else { Pictures::Photographs };
    let open = || Reader::open(&cameras, &paths, &times, pictures);
    let reader = open()?;
    tell(&cameras, &reader.timeline);
    let settings = settings(arguments)?;
    let mut failures = Vec::new();
    let (fit, frames) = fit(&cameras, reader, open, &settings, &mut failures)?;
    let take = written(&cameras, &open()?.timeline, &fit, &frames, arguments.rate);
    out.write(&encoded(&take, &kind)?)?;
    if let Some(out) = hand_out {
        out.write(fit.hand.to_toml().as_bytes())?;
    }
    conclude(&take, &fit, &arguments.out, &failures)
}

/// Fits all moments of a recording: the take's hand and volume, and each frame.
fn fit<'a>(
    cameras: &[Camera],
    mut reader: Reader<'a>,
    open: impl Fn() -> Result<Reader<'a>>,
    settings: &TakeSettings,
    failures: &mut Vec<String>,
) -> Result<(TakeFit, Vec<Option<FrameFit>>)> {
    let count = reader.moments().len();
    let some = count.min(WHOLE);
    let bar = Bar::new();
    let mut chosen = Vec::with_capacity(some);
    for k in 0..some {
        // The middle of each of so many equal parts.
        let moment = (2 * k + 1) * count / (2 * some);
        chosen.push(seen(&mut reader, moment, failures));
    }
    let fit = fit_take(cameras, &chosen, settings, &bar)?;
    if some == count {
        let frames = fit.frames.iter().cloned().map(Some).collect();
        return Ok((fit, frames));
    }
    failures.clear();
    let mut frames = Vec::with_capacity(count);
    let mut reader = open()?;
    bar.begin("fit frames", count);
    for first in (0..count).step_by(BLOCK) {
        let block: Vec<TakeFrame> = (first..count.min(first + BLOCK))
            .map(|moment| seen(&mut reader, moment, failures))
            .collect();
        let fitted = block.par_iter().map(|frame| {
            let fitted = fit_frame(cameras, frame, &fit);
            bar.step();
            match fitted {
                Ok(frame) => Ok(Some(frame)),
                Err(phalanx::Error::NoHand) => Ok(None),
                Err(error) => Err(error),
            }
        });
        frames.extend(fitted.collect::<phalanx::Result<Vec<_>>>()?);
    }
    Ok((fit, frames))
}

/// Reads a moment; what cannot be read is noted and missing.
fn seen(reader: &mut Reader<'_>, moment: usize, failures: &mut Vec<String>) -> TakeFrame {
    let Seen { frame, failures: new } = reader.read(moment);
    let name = &reader.moments()[moment].name;
    failures.extend(new.into_iter().map(|failure| format!("frame {name}, camera {failure}")));
    frame
}

fn kind(out: &Path) -> Result<String> {
    if out == Path::new("-") {
        return Ok("csv".to_owned());
    }
    let kind = out.extension().map(|kind| kind.to_string_lossy().to_lowercase());
    match kind {
        Some(kind) if ["csv", "jsonl", "npz"].contains(&kind.as_str()) => Ok(kind),
        _ => bail!(
            "{}: the name must end with .csv, .jsonl or .npz; `phalanx convert` writes other formats",
            out.display()
        ),
    }
}

/// The cameras that have a recording, and where it is.
fn cameras_and_paths(rig: &Rig, recordings: &[String]) -> Result<(Vec<Camera>, Vec<PathBuf>)> {
    let assigned = cameras::assign(&rig.cameras, recordings)?;
    for (camera, _) in rig.cameras.iter().zip(&assigned).filter(|(_, path)| path.is_none()) {
        eprintln!("phalanx: camera '{}' has no recording and is left out", camera.name);
    }
    let both = rig.cameras.iter().zip(assigned);
    Ok(both.filter_map(|(camera, path)| Some((camera.clone(), path?))).unzip())
}

fn times(arguments: &Arguments, cameras: &[Camera]) -> Result<Vec<Option<Vec<f64>>>> {
    let Some(path) = &arguments.timestamps else { return Ok(vec![None; cameras.len()]) };
    let mut all = recording::read_timestamps(path)?;
    let of = |camera: &Camera| {
        let times = all.remove(&camera.name);
        let times = times.with_context(|| {
            format!("{}: there are no times of camera '{}'", path.display(), camera.name)
        })?;
        Ok(Some(times))
    };
    cameras.iter().map(of).collect()
}

fn settings(arguments: &Arguments) -> Result<TakeSettings> {
    let side = match arguments.side {
        SideName::Right => Side::Right,
        SideName::Left => Side::Left,
    };
    Ok(match &arguments.hand {
        Some(path) => {
            let hand = input::hand(path)?;
            ensure!(hand.side == side, "{}: it is the other hand; see --side", path.display());
            TakeSettings { hand, proportions: Proportions::Given }
        }
        None => TakeSettings {
            hand: HandShape { side, ..HandShape::adult() },
            proportions: Proportions::FromTake,
        },
    })
}

/// Says what was found of the recordings.
fn tell(cameras: &[Camera], timeline: &Timeline) {
    eprintln!("phalanx: {} moments by {} cameras", timeline.moments.len(), cameras.len());
    let counts = timeline.missing.iter().zip(&timeline.unmatched);
    for (camera, (&missing, &unmatched)) in cameras.iter().zip(counts) {
        if missing + unmatched > 0 {
            eprintln!(
                "phalanx: camera '{}' has no frame at {missing} moments; {unmatched} of its frames belong to none",
                camera.name
            );
        }
    }
}

fn written(
    cameras: &[Camera],
    timeline: &Timeline,
    fit: &TakeFit,
    frames: &[Option<FrameFit>],
    rate: Option<f64>,
) -> Take {
    let has_times = timeline.moments.iter().all(|moment| moment.time.is_some());
    let rate = rate.unwrap_or(USUAL_RATE);
    let frame = |(index, fit): (usize, &Option<FrameFit>)| {
        let moment = &timeline.moments[index];
        let time = moment.time.filter(|_| has_times).unwrap_or(index as f64 / rate);
        take::frame(cameras, (index, moment), time, fit.as_ref())
    };
    let header = take::header(cameras, fit, (!has_times).then_some(rate));
    Take { header, frames: frames.iter().enumerate().map(frame).collect() }
}

/// The take as a file of a kind.
fn encoded(take: &Take, kind: &str) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    match kind {
        "jsonl" => write_json_lines(take, &mut bytes)?,
        "npz" => bytes = write_npz(take)?,
        _ => write_csv(take, &mut bytes)?,
    }
    Ok(bytes)
}

/// Says how it went; some frames that could not be read make another exit code.
fn conclude(take: &Take, fit: &TakeFit, out: &Path, failures: &[String]) -> Result<ExitCode> {
    const NAMED: usize = 20;
    for failure in failures.iter().take(NAMED) {
        eprintln!("phalanx: {failure}");
    }
    if failures.len() > NAMED {
        eprintln!("phalanx: and {} more", failures.len() - NAMED);
    }
    let with_hand = take.frames.iter().filter(|frame| frame.estimate.is_some()).count();
    let doubted = take.frames.iter().filter(|frame| !frame.doubts.is_empty()).count();
    ensure!(with_hand > 0, "no frame shows a hand");
    eprintln!(
        "phalanx: {with_hand} of {} frames show the hand, {doubted} are doubted (column `doubts`); the hand is \
         {:.0} mm long; {}",
        take.frames.len(),
        fit.hand.length_mm(),
        out.display()
    );
    Ok(if failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
