//! `phalanx calibrate-hand`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use phalanx::{Estimator, Picture, Refiner, Workspace};
use phalanx_refine::{
    BundleAdjustment, BundleFrame, CameraMotion, ExtrinsicsPrior, NuisanceParameters,
    PoseFitSettings,
};
use serde_json::json;

use crate::form::Form;
use crate::input;
use crate::segment::{Pictures, Prepared, SegmentArguments};
use phalanx_cli::files::Output;

/// More frames tell little more, and each takes its time.
const MOST_FRAMES: usize = 30;
/// Fewer leave most of a hand's proportions open.
const LEAST_FRAMES: usize = 3;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The model, as `phalanx train` writes it.
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Pictures of one moving hand: a folder for each camera of the model, named like it, with the
    /// same file names in each. Of more than 30 frames 30 are taken, evenly spaced.
    #[arg(long, value_name = "DIR")]
    frames: PathBuf,
    #[command(flatten)]
    segment: SegmentArguments,
    /// The cameras may stand up to some degrees from where they are said to.
    #[arg(long)]
    doubt_cameras: bool,
    /// Where the hand goes.
    #[arg(long, value_name = "FILE.toml")]
    out: PathBuf,
    #[command(flatten)]
    form: Form,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let output = Output::new(&arguments.out, &[&arguments.model])?;
    let estimator = input::model(&arguments.model)?;
    let names = frame_names(&arguments.frames, &estimator)?;
    let nuisance = NuisanceParameters::default();
    let refinement = PoseFitSettings { nuisance: Some(nuisance), ..PoseFitSettings::default() };
    let refiner = Refiner::for_estimator(&estimator, refinement)?;
    let found = arguments.segment.pictures()?;
    let mut frames = Vec::new();
    for name in &names {
        match frame((&arguments.frames, name), &found, &estimator, &refiner) {
            Ok(frame) => frames.push(frame),
            Err(error) => eprintln!("phalanx: frame {name} is left out: {error:#}"),
        }
    }
    let used = frames.len();
    ensure!(used >= LEAST_FRAMES, "{used} frames can be used; at least {LEAST_FRAMES} are needed");
    let cameras = nuisance.cameras.filter(|_| arguments.doubt_cameras);
    let cameras =
        cameras.map(|cameras| ExtrinsicsPrior { motion: CameraMotion::Static, ..cameras });
    let calibration = BundleAdjustment { cameras, ..BundleAdjustment::default() };
    let calibrated = refiner.calibrate(&calibration, &frames)?;
    output.write(calibrated.hand.to_toml().as_bytes())?;
    let overlaps: Vec<f64> = calibrated.ious.into_iter().flatten().collect();
    let mean = overlaps.iter().sum::<f64>() / overlaps.len() as f64;
    let said = json!({
        "hand": arguments.out, "frames": used, "left_out": names.len() - used, "overlap": mean,
        "border_px": calibrated.boundary_rms_px, "converged": calibrated.converged,
    });
    arguments.form.say(&output, &said, || {
        let settled = if calibrated.converged { "" } else { "; it stopped before it settled" };
        format!(
            "from {used} frames; silhouettes overlap by {mean:.3}, borders are {:.2} px apart{settled}",
            calibrated.boundary_rms_px,
        )
    })
}

/// The names of the frames of the first camera's folder, at most so many, evenly spaced.
fn frame_names(folder: &Path, estimator: &Estimator) -> Result<Vec<String>> {
    let folder = folder.join(&estimator.rig().cameras[0].name);
    let name = || folder.display().to_string();
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&folder).with_context(name)? {
        names.push(entry.with_context(name)?.file_name().to_string_lossy().into_owned());
    }
    names.sort_unstable();
    let count = names.len().min(MOST_FRAMES);
    Ok((0..count).map(|k| names[k * names.len() / count].clone()).collect())
}

/// One frame in every camera: the picture of a name in each camera's folder of a folder.
fn frame(
    (folder, name): (&Path, &str),
    found: &Pictures,
    estimator: &Estimator,
    refiner: &Refiner,
) -> Result<BundleFrame> {
    let mut prepared = Vec::new();
    for camera in &estimator.rig().cameras {
        let picture = input::picture(&folder.join(&camera.name).join(name), None)?;
        prepared.push(found.prepared(&camera.name, &picture)?);
    }
    let pictures: Vec<Picture<'_>> = prepared.iter().map(Prepared::as_picture).collect();
    Ok(refiner.frame(&estimator.estimate(&pictures, &mut Workspace::default())?)?)
}
