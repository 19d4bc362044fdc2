//! `phalanx train` and `phalanx merge`.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use phalanx::{Error, Estimator, Framing, PartialTraining, Preset, Shard, Trainer};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose, PoseTable};
use serde_json::json;

use crate::checkpoint::Checkpoint;
use crate::counts::counted;
use crate::forecast::Forecast;
use crate::form::Form;
use crate::input;
use crate::progress::{Bar, loss_lines};
use crate::rig::check;
use phalanx_cli::files::Output;
use phalanx_cli::parts;
use phalanx_cli::reading;

/// The rig of the examples: three cameras about a desk, `side`, `top` and `other_side`.
const DESK: &str = include_str!("../fixtures/desk.toml");

/// How many samples may be asked for.
const SAMPLES: std::ops::RangeInclusive<usize> = 100..=10_000_000;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The cameras and the working volume, TOML; three cameras about a desk by default.
    #[arg(long, value_name = "FILE.toml")]
    rig: Option<PathBuf>,
    /// Train for these cameras of the rig only: names separated by commas.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    cameras: Vec<String>,
    /// The hand, TOML; a mean adult's by default.
    #[arg(long, value_name = "FILE.toml")]
    hand: Option<PathBuf>,
    /// How much time the model is worth.
    #[arg(long, value_enum, default_value_t)]
    preset: PresetName,
    /// What of the pictures is looked at.
    #[arg(long, value_enum, default_value_t)]
    framing: FramingName,
    /// Scenes to learn from; the preset's number by default.
    #[arg(long, value_name = "N", value_parser = samples)]
    samples: Option<usize>,
    /// Learn from these poses in place of random ones: CSV, degrees. Where θ_Z is the same in all, it is
    /// drawn from 0° to 90°.
    #[arg(long, value_name = "FILE.csv")]
    poses: Option<PathBuf>,
    /// The seed of all that is random.
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    /// Do the i-th of n equal parts of the work and write it to `--out`; `phalanx merge` joins the
    /// parts to the model that a single run gives. A run that was broken off goes on where it was, from
    /// OUT.unfinished, if it is started again.
    #[arg(long, value_name = "i/n", value_parser = Shard::from_str)]
    shard: Option<Shard>,
    /// Where the model goes, or a shard's part.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    form: Form,
}

#[derive(Args)]
pub(crate) struct MergeArguments {
    /// The parts that `phalanx train --shard` wrote, in any order.
    #[arg(required = true, value_name = "PART")]
    parts: Vec<PathBuf>,
    /// Where the model goes.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    form: Form,
}

/// The presets by name.
#[derive(Clone, Copy, Default, ValueEnum)]
enum PresetName {
    /// 4,000 scenes: some seconds.
    Fast,
    /// 120,000 scenes: some minutes.
    #[default]
    Default,
    /// 240,000 scenes: some ten minutes.
    Best,
}

/// Framings by name.
#[derive(Clone, Copy, Default, ValueEnum)]
enum FramingName {
    /// The whole picture, whose middle the hand is in.
    #[default]
    Picture,
    /// A window on a hand that may be anywhere in the rig's volume.
    Window,
}

impl From<PresetName> for Preset {
    fn from(name: PresetName) -> Self {
        match name {
            PresetName::Fast => Self::Fast,
            PresetName::Default => Self::Default,
            PresetName::Best => Self::Best,
        }
    }
}

impl From<FramingName> for Framing {
    fn from(name: FramingName) -> Self {
        match name {
            FramingName::Picture => Self::Picture,
            FramingName::Window => Self::Window,
        }
    }
}

fn samples(text: &str) -> Result<usize, String> {
    let samples = text.parse().map_err(|error| format!("{error}"))?;
    if SAMPLES.contains(&samples) {
        return Ok(samples);
    }
    Err(format!("{samples} is not between {} and {}", SAMPLES.start(), SAMPLES.end()))
}

pub(crate) fn train(arguments: &Arguments) -> Result<()> {
    let inputs = arguments.rig.iter().chain(&arguments.hand).chain(&arguments.poses);
    let out = Output::new(&arguments.out, &inputs.collect::<Vec<_>>())?;
    let rig = rig(arguments)?;
    let hand = arguments.hand.as_deref().map(input::hand).transpose()?;
    let hand = hand.unwrap_or_else(HandShape::adult);
    let preset = Preset::from(arguments.preset);
    let samples = arguments.samples.unwrap_or(preset.scenes());
    let mut trainer = Trainer::preset(preset)
        .framing(arguments.framing.into())
        .samples(samples)
        .seed(arguments.seed);
    if let Some(path) = &arguments.poses {
        trainer = trainer.recorded(poses(path)?);
    }
    let shard = arguments.shard.unwrap_or(Shard::WHOLE);
    let forecast = Forecast::new(trainer.cost(rig.cameras.len(), shard), rig.cameras.len());
    let mut checkpoint = Checkpoint::beside(&out, ".unfinished");
    let earlier = unfinished(&checkpoint);
    if let Some(earlier) = &earlier {
        forecast.say(&format!("going on after {}", counted(earlier.seen(), "scene")));
    }
    let mut keep = |part: &PartialTraining| checkpoint.keep(|| Ok(part.to_bytes()?));
    let part = trainer.resume_shard(&rig, &hand, shard, earlier, &mut keep, &forecast);
    let part = part.map_err(|error| explained(error, &checkpoint))?;
    let done = finish(arguments, part, &out, forecast);
    if done.is_ok() {
        checkpoint.remove();
    }
    done
}

/// What an earlier run left. One that cannot be read is said, and the training begins anew.
fn unfinished(checkpoint: &Checkpoint) -> Option<PartialTraining> {
    let (path, bytes) = checkpoint.read()?;
    let part = PartialTraining::from_bytes(&bytes);
    part.inspect_err(|error| {
        eprintln!("phalanx: {}: {error}; the training begins anew", path.display());
    })
    .ok()
}

/// An error of a training that went on: that of another one says which file to remove, and one whose cameras do not show
/// the hand how to find where it works.
fn explained(error: Error, checkpoint: &Checkpoint) -> anyhow::Error {
    match (&error, checkpoint.path()) {
        (Error::ForeignPart { .. }, Some(path)) => anyhow::anyhow!(
            "{}: an unfinished training with other settings ({error}); finish it, or remove the file",
            path.display()
        ),
        (Error::TooManyLost { .. }, _) => anyhow::anyhow!(
            "{error}; `phalanx rig volume` finds where the hand works, from a recording"
        ),
        _ => error.into(),
    }
}

/// Writes the model, or a shard's part.
fn finish(
    arguments: &Arguments,
    part: PartialTraining,
    out: &Output,
    forecast: Forecast,
) -> Result<()> {
    if arguments.shard.is_none() {
        return save(&part.finish(&forecast)?, out, arguments.form);
    }
    drop(forecast);
    let lost = part.losses();
    if lost.count() > 0 {
        for line in loss_lines(&lost.count().to_string(), lost) {
            eprintln!("phalanx: {line}");
        }
    }
    let bytes = part.to_bytes()?;
    out.write(&bytes)?;
    let said = json!({ "part": arguments.out, "bytes": bytes.len(), "lost": lost.count() });
    arguments.form.say(out, &said, || format!("{} KiB", bytes.len().div_ceil(1024)))
}

pub(crate) fn merge(arguments: &MergeArguments) -> Result<()> {
    let out = Output::new(&arguments.out, &arguments.parts)?;
    let merged = parts::merged(&arguments.parts)?;
    if let [first, others @ ..] = merged.makers()
        && !others.is_empty()
    {
        let others: Vec<String> = others.iter().map(ToString::to_string).collect();
        eprintln!(
            "phalanx: the parts were made by unlike programs or machines ({first}; {}): the model may differ in its \
             last digits from that of a single run",
            others.join("; ")
        );
    }
    let bar = Bar::new();
    let estimator = merged.finish(&bar)?;
    drop(bar);
    save(&estimator, &out, arguments.form)
}

/// The rig that is asked for.
fn rig(arguments: &Arguments) -> Result<Rig> {
    let rig = match &arguments.rig {
        None => Rig::from_toml(DESK)?,
        Some(path) => check::read(path)?,
    };
    if arguments.cameras.is_empty() {
        return Ok(rig);
    }
    Ok(rig.select(&arguments.cameras.iter().map(|name| name.trim()).collect::<Vec<_>>())?)
}

/// The poses of a file; what is odd about it goes to standard error.
fn poses(path: &Path) -> Result<Vec<Pose>> {
    let name = || path.display().to_string();
    let table = PoseTable::read(reading::open(path).with_context(name)?).with_context(name)?;
    for warning in &table.warnings {
        eprintln!("phalanx: {}: {warning}", path.display());
    }
    Ok(table.poses)
}

/// Writes a model and says what it is.
fn save(estimator: &Estimator, out: &Output, form: Form) -> Result<()> {
    let bytes = estimator.to_bytes()?;
    out.write(&bytes)?;
    let cameras = &estimator.rig().cameras;
    let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
    let said = json!({ "model": out.path(), "cameras": names, "bytes": bytes.len() });
    form.say(out, &said, || {
        let size = bytes.len().div_ceil(1024);
        format!("a model for the cameras {}; {size} KiB", names.join(", "))
    })
}
