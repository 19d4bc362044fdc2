//! `phalanx track`.

pub(crate) mod take;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use phalanx::{
    FrameFit, Progress, Proportions, TakeFit, TakeFrame, TakeSettings, fit_frame, fit_take,
};
use phalanx_camera::Camera;
use phalanx_cli::files::Output;
use phalanx_hand::{HandShape, Side};
use phalanx_io::take::Take;
use rayon::prelude::*;

use crate::progress::Bar;
use crate::recording::reader::Reader;
use crate::recording::source::{RecordingArguments, Source};
use crate::recording::timeline::Timeline;
use crate::rig::check;
use crate::side::SideName;
use crate::{input, take_file};

/// Recordings of up to so many moments are fitted as a whole. Of longer ones as many moments, evenly spread,
/// tell the hand, and then every frame is fitted with it, so that memory does not grow with the recording.
const WHOLE: usize = 240;

/// Frames that are fitted at a time, each on its own.
const BLOCK: usize = 32;

/// The rate that is assumed where frames have no times, Hz.
const USUAL_RATE: f64 = 30.0;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    recording: RecordingArguments,
    /// The cameras, as `phalanx rig import` writes them.
    #[arg(long, value_name = "FILE.toml")]
    rig: PathBuf,
    /// The person's hand, as `calibrate-hand` or `--save-hand` writes it; fitted on the way by default.
    #[arg(long, value_name = "FILE.toml")]
    hand: Option<PathBuf>,
    /// Which hand it is.
    #[arg(long, value_enum, default_value_t)]
    side: SideName,
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

pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let kind = kind(&arguments.out)?;
    let rig = check::read(&arguments.rig)?;
    let source = Source::new(&rig, &arguments.recording)?;
    let given = [Some(&arguments.rig), arguments.hand.as_ref()];
    let inputs: Vec<&PathBuf> = source.inputs().chain(given.into_iter().flatten()).collect();
    let out = Output::new(&arguments.out, &inputs)?;
    let hand_out = arguments.save_hand.as_ref().map(|path| Output::new(path, &inputs));
    let hand_out = hand_out.transpose()?;
    let reader = source.reader()?;
    tell(&source.cameras, &reader.timeline);
    let settings = settings(arguments)?;
    let mut failures = Vec::new();
    let timeline = reader.timeline.clone();
    let (fit, frames) = fit(&source, reader, &settings, &mut failures)?;
    let take = written(&source.cameras, &timeline, &fit, &frames, arguments.rate);
    let bytes = take_file::encoded(&take, &kind)?.context("the kind was checked")?;
    out.write(&bytes)?;
    if let Some(out) = hand_out {
        out.write(fit.hand.to_toml().as_bytes())?;
    }
    conclude(&take, &fit, &arguments.out, &failures)
}

/// Fits all moments of a recording: the take's hand and volume, and each frame.
fn fit(
    source: &Source,
    mut reader: Reader<'_>,
    settings: &TakeSettings,
    failures: &mut Vec<String>,
) -> Result<(TakeFit, Vec<Option<FrameFit>>)> {
    let (cameras, count) = (&source.cameras, reader.moments().len());
    let bar = Bar::new();
    let fit = fit_take(cameras, &reader.read_some(WHOLE, failures), settings, &bar)?;
    if count <= WHOLE {
        let frames = fit.frames.iter().cloned().map(Some).collect();
        return Ok((fit, frames));
    }
    failures.clear();
    let mut frames = Vec::with_capacity(count);
    let mut reader = source.reader()?;
    bar.begin("fit frames", count);
    for first in (0..count).step_by(BLOCK) {
        let block = first..count.min(first + BLOCK);
        let block: Vec<TakeFrame> =
            block.map(|moment| reader.read_noting(moment, failures)).collect();
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

fn kind(out: &Path) -> Result<String> {
    if out == Path::new("-") {
        return Ok("csv".to_owned());
    }
    match take_file::extension(out) {
        kind if ["csv", "jsonl", "npz"].contains(&kind.as_str()) => Ok(kind),
        _ => bail!(
            "{}: the name must end with .csv, .jsonl or .npz; `phalanx convert` writes other formats",
            out.display()
        ),
    }
}

fn settings(arguments: &Arguments) -> Result<TakeSettings> {
    let side = Side::from(arguments.side);
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
