//! `phalanx track`.

pub(crate) mod take;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use phalanx::{
    Delay, FrameFit, Progress, Proportions, TakeFit, TakeSettings, TrackedFrame, Tracker, fit_take,
};
use phalanx_camera::Camera;
use phalanx_cli::files::Output;
use phalanx_hand::{HandShape, Side};
use phalanx_io::take::Take;

use crate::progress::Bar;
use crate::recording::reader::Reader;
use crate::recording::source::{RecordingArguments, Source};
use crate::recording::timeline::Timeline;
use crate::rig::check;
use crate::side::SideName;
use crate::{input, take_file};

/// Recordings of up to so many moments are fitted as a whole. Of longer ones as many moments, evenly spread,
/// tell the hand, and then it is tracked from frame to frame, so that no more pictures are held at a time.
const WHOLE: usize = 240;

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
    /// Fit all moments together, each in the light of all others, also of a recording of more than 240 moments,
    /// which is tracked from frame to frame by default; takes memory and some twenty times as long.
    #[arg(long)]
    whole_take: bool,
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
    let times = times(&timeline, arguments.rate);
    let most = if arguments.whole_take { usize::MAX } else { WHOLE };
    let (fit, frames) = fit(&source, reader, &settings, (most, &times), &mut failures)?;
    let take = written(&source.cameras, &timeline, &fit, (&frames, &times), arguments.rate);
    let bytes = take_file::encoded(&take, &kind)?.context("the kind was checked")?;
    out.write(&bytes)?;
    if let Some(out) = hand_out {
        out.write(fit.hand.to_toml().as_bytes())?;
    }
    conclude(&take, &fit, &arguments.out, &failures)
}

/// Fits all moments of a recording: the take's hand and volume, and each frame; as a whole up to `most`
/// moments.
fn fit(
    source: &Source,
    mut reader: Reader<'_>,
    settings: &TakeSettings,
    (most, times): (usize, &[f64]),
    failures: &mut Vec<String>,
) -> Result<(TakeFit, Vec<Option<FrameFit>>)> {
    let (cameras, count) = (&source.cameras, reader.moments().len());
    let bar = Bar::new();
    let fit = fit_take(cameras, &reader.read_some(most, failures), settings, &bar)?;
    if count <= most {
        let frames = fit.frames.iter().cloned().map(Some).collect();
        return Ok((fit, frames));
    }
    failures.clear();
    let mut tracked: Vec<TrackedFrame> = Vec::with_capacity(count);
    let mut reader = source.reader()?;
    let mut tracker = Tracker::of_take(cameras, &fit, Delay::OneFrame)?;
    bar.begin("track the hand", count);
    for (moment, &time) in times.iter().enumerate() {
        tracked.extend(tracker.push(time, &reader.read_noting(moment, failures))?);
        bar.step();
    }
    tracked.extend(tracker.finish()?);
    Ok((fit, tracked.into_iter().map(|frame| frame.fit).collect()))
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

/// When each moment was, seconds: by the cameras' clocks or, where they have none, by the rate.
fn times(timeline: &Timeline, rate: Option<f64>) -> Vec<f64> {
    let clock: Option<Vec<f64>> = timeline.moments.iter().map(|moment| moment.time).collect();
    let rate = rate.unwrap_or(USUAL_RATE);
    clock.unwrap_or_else(|| (0..timeline.moments.len()).map(|k| k as f64 / rate).collect())
}

fn written(
    cameras: &[Camera],
    timeline: &Timeline,
    fit: &TakeFit,
    (frames, times): (&[Option<FrameFit>], &[f64]),
    rate: Option<f64>,
) -> Take {
    let has_times = timeline.moments.iter().all(|moment| moment.time.is_some());
    let frame = |(index, fit): (usize, &Option<FrameFit>)| {
        take::frame(cameras, (index, &timeline.moments[index]), times[index], fit.as_ref())
    };
    let header = take::header(cameras, fit, (!has_times).then(|| rate.unwrap_or(USUAL_RATE)));
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
