//! `cargo xtask train`: learns an estimator and saves it.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context, Result, ensure};
use clap::{Args, ValueEnum};
use phalanx::{
    Estimator, Framing, PartialTraining, Preset, Progress, RegressorConfig, Shard, Trainer,
    Training,
};
use phalanx_camera::Rig;
use phalanx_hand::HandShape;

use crate::data::data_set::DataSet;
use crate::data::sets::{self, Augment};
use crate::eval::held_out::method::nystrom;
use crate::eval::table1::{PaperCounts, TableMethod};
use crate::files::{self, Output};
use crate::memory;
use crate::progress;
use crate::recipes::preset_name::PresetName;

#[derive(Args)]
pub struct Arguments {
    /// `open-close`, `complex`, `random`, or a file of poses (CSV, degrees); where θ_Z does not vary in
    /// it, each pose is repeated at seven angles from 0° to 90°.
    #[arg(long, default_value = "complex")]
    data_set: String,
    /// The cameras: names from the rig separated by commas, or `1` for the top view, `3` for all.
    #[arg(long, default_value = "3")]
    views: String,
    /// The regressor.
    #[arg(long, value_enum, default_value = "kernel_ridge")]
    kernels: TableMethod,
    /// Learn by this preset, from damaged random scenes: of the pose prior or, with `--poses`, of
    /// poses from a file.
    #[arg(long, value_enum, conflicts_with_all = ["data_set", "kernels", "augment"])]
    preset: Option<PresetName>,
    /// With `--preset`, poses to learn from in place of the prior: CSV, degrees; where θ_Z does not
    /// vary in it, it is drawn from 0° to 90°.
    #[arg(long, value_name = "FILE.csv", requires = "preset")]
    poses: Option<PathBuf>,
    /// With `--preset`, what of the pictures is looked at: `window` learns from hands anywhere in the
    /// rig's volume, their arms leaning, and finds out where they are.
    #[arg(long, value_enum, requires = "preset", conflicts_with = "poses")]
    framing: Option<FramingName>,
    /// The rig, TOML; the desk of fixtures/ by default.
    #[arg(long, value_name = "FILE.toml")]
    rig: Option<PathBuf>,
    /// The hand, TOML; the mean adult of fixtures/ by default.
    #[arg(long, value_name = "FILE.toml")]
    hand: Option<PathBuf>,
    /// With `--data-set random` or `--preset`, how many independent poses are learnt from: 20,000, or
    /// what the preset says, by default.
    #[arg(long, value_name = "N", value_parser = sets::samples)]
    samples: Option<usize>,
    /// With `--data-set random`, give every sample a hand of its own, moved cameras and a ragged
    /// silhouette.
    #[arg(long)]
    augment: bool,
    /// With `--data-set random`, do the i-th of n equal parts of the work and write it to `--out`;
    /// `cargo xtask merge` joins the parts.
    #[arg(long, value_name = "i/n", value_parser = Shard::from_str, requires = "out")]
    shard: Option<Shard>,
    /// With `--preset`, learn too how estimates err, from 4,000 further scenes: refinement then tries
    /// other poses where one is not enough.
    #[arg(long, requires = "preset", conflicts_with_all = ["poses", "shard"])]
    hypotheses: bool,
    /// Say how much memory was held at most.
    #[arg(long)]
    memory: bool,
    /// Where the model goes, or a shard's part; target/hand.phalanx by default.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Framings by name.
#[derive(Clone, Copy, ValueEnum)]
enum FramingName {
    /// The whole picture, whose middle the hand is in.
    Picture,
    /// A window on the hand.
    Window,
}

impl FramingName {
    fn framing(self) -> Framing {
        match self {
            Self::Picture => Framing::Picture,
            Self::Window => Framing::Window,
        }
    }
}

/// Where a model goes by default.
const MODEL: &str = "target/hand.phalanx";

/// Random poses that are learnt from, unless it is said how many.
const RANDOM_SAMPLES: usize = 20_000;

/// The regressor, with the paper's counts where it selects; dense kernel regression is that of
/// [`Training`], for pictures that were not drawn.
fn regressor(method: TableMethod, counts: PaperCounts) -> RegressorConfig {
    match method {
        TableMethod::KernelRidge => Training::default().regressor,
        method => method.regressor(counts).expect("nearest neighbours cannot be asked for"),
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    learn(arguments)?;
    if !arguments.memory {
        return Ok(());
    }
    let bytes = memory::peak().context("this system does not say how much memory was held")?;
    files::print(&format!("peak memory: {} MiB\n", bytes.div_ceil(1 << 20)))
}

/// Where the model goes, or a shard's part.
fn output(arguments: &Arguments) -> Result<Output> {
    let out = arguments.out.as_deref().unwrap_or(MODEL.as_ref());
    let files = arguments.rig.iter().chain(&arguments.hand).chain(&arguments.poses);
    let files = files.map(PathBuf::as_path).chain([arguments.data_set.as_ref()]);
    files::output(out, &files.collect::<Vec<_>>())
}

fn learn(arguments: &Arguments) -> Result<()> {
    let out = output(arguments)?;
    let hand = files::hand(arguments.hand.as_deref())?;
    let rig = views(&files::rig(arguments.rig.as_deref())?, &arguments.views)?;
    if let Some(name) = arguments.preset {
        let part = by_preset(name.preset(), arguments, &rig, &hand)?;
        return write(part, arguments, &out);
    }
    if arguments.data_set == "random" {
        return write(random(arguments, &rig, &hand)?, arguments, &out);
    }
    ensure!(
        arguments.shard.is_none() && !arguments.augment && arguments.samples.is_none(),
        "--samples, --augment and --shard go with --data-set random"
    );
    let data_set = match arguments.data_set.as_str() {
        name @ ("open-close" | "complex") => DataSet::stored(name)?,
        path => DataSet::from_file("poses", path.as_ref())?,
    };
    let counts = PaperCounts::paper(rig.cameras.len(), &data_set.name);
    let regressor = regressor(arguments.kernels, counts);
    let training = Training { regressor, ..Training::default() };
    let bar = progress::Bar::new();
    let estimator = training.run(&rig, &hand, &data_set.poses, &bar)?;
    drop(bar);
    save(&estimator, &out)
}

/// Learns from independent random poses, of which there may be any number.
fn random(arguments: &Arguments, rig: &Rig, hand: &HandShape) -> Result<PartialTraining> {
    let augment = if arguments.augment { Augment::Yes } else { Augment::No };
    let samples = arguments.samples.unwrap_or(RANDOM_SAMPLES);
    let set = sets::random(rig, hand, samples, augment);
    let regressor = match arguments.kernels {
        TableMethod::KernelRidge => nystrom(),
        method => regressor(method, PaperCounts::paper(rig.cameras.len(), set.name)),
    };
    let training = Training { regressor, ..Training::default() };
    let shard = arguments.shard.unwrap_or(Shard::WHOLE);
    Ok(training.shard(rig, hand, &set, shard, &progress::Bar::new())?)
}

/// Learns as a preset says, of the prior's poses or a file's.
fn by_preset(
    preset: Preset,
    arguments: &Arguments,
    rig: &Rig,
    hand: &HandShape,
) -> Result<PartialTraining> {
    let framing = arguments.framing.map_or_else(Framing::default, FramingName::framing);
    let samples = arguments.samples.unwrap_or(preset.scenes());
    let mut trainer = Trainer::preset(preset).framing(framing).samples(samples);
    if let Some(path) = &arguments.poses {
        trainer = trainer.recorded(files::poses(path)?.poses);
    }
    let shard = arguments.shard.unwrap_or(Shard::WHOLE);
    Ok(trainer.fit_shard(rig, hand, shard, &progress::Bar::new())?)
}

/// Writes the model, or a shard's part.
fn write(part: PartialTraining, arguments: &Arguments, out: &Output) -> Result<()> {
    if arguments.shard.is_none() {
        return save(&finish(part, arguments.hypotheses, &progress::Bar::new())?, out);
    }
    let bytes = part.to_bytes()?;
    out.write(&bytes)?;
    out.say(&format!("{} KiB", bytes.len().div_ceil(1024)))
}

/// The estimator of a whole training, with a model of its errors if that is asked for.
pub(crate) fn finish(
    part: PartialTraining,
    hypotheses: bool,
    progress: &dyn Progress,
) -> Result<Estimator> {
    Ok(if hypotheses { part } else { part.without_error_model() }.finish(progress)?)
}

/// Writes a model and says what it is.
pub(crate) fn save(estimator: &Estimator, out: &Output) -> Result<()> {
    let bytes = estimator.to_bytes()?;
    out.write(&bytes)?;
    let cameras = &estimator.rig().cameras;
    let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
    out.say(&format!(
        "learnt through {}; reads {} features, {} kernel centres; {} KiB",
        names.join(", "),
        estimator.regressor().features(),
        estimator.regressor().kept_samples(),
        bytes.len().div_ceil(1024),
    ))
}

/// The cameras that were asked for.
fn views(rig: &Rig, views: &str) -> Result<Rig> {
    let rig = match views {
        "3" => rig.clone(),
        "1" => rig.select(&["top"])?,
        names => rig.select(&names.split(',').map(str::trim).collect::<Vec<_>>())?,
    };
    Ok(rig)
}
