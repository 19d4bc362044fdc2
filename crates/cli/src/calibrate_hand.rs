//! `phalanx calibrate-hand`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use phalanx::{Cause, Estimate, Estimator, Picture, Refiner, ViewDoubt, Workspace};
use phalanx_refine::{
    BundleAdjustment, BundleFrame, CameraMotion, ExtrinsicsPrior, NuisanceParameters,
    PoseFitSettings,
};
use phalanx_sampling::random_subset;
use serde_json::json;

use crate::counts::counted;
use crate::form::Form;
use crate::input;
use crate::output::Doubt;
use crate::postures;
use crate::segment::{Pictures, Prepared, SegmentArguments};
use phalanx_cli::files::Output;

/// More frames tell little more, and each takes its time.
const MOST_FRAMES: usize = 30;
/// The seed by which they are drawn.
const SUBSET_SEED: u64 = 0;
/// Fewer leave most of a hand's proportions open.
const LEAST_FRAMES: usize = 3;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The model, as `phalanx train` writes it.
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Pictures of one moving hand: a folder for each camera of the model, named like it, with the
    /// same file names in each. Of more than 30 frames 30 are drawn.
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
    let estimator = input::model(&arguments.model)?;
    let folders = estimator.rig().cameras.iter().map(|camera| arguments.frames.join(&camera.name));
    let files = [&arguments.model].into_iter().chain(arguments.segment.path());
    let output = Output::new(&arguments.out, &folders.chain(files.cloned()).collect::<Vec<_>>())?;
    let names = frame_names(&arguments.frames, &estimator)?;
    let nuisance = NuisanceParameters::default();
    let refinement = PoseFitSettings { nuisance: Some(nuisance), ..PoseFitSettings::default() };
    let refiner = Refiner::for_estimator(&estimator, refinement)?;
    let found = arguments.segment.pictures()?;
    let mut frames = Vec::new();
    for name in &names {
        match frame((&arguments.frames, name), &found, &estimator) {
            Ok(frame) => frames.push(frame),
            Err(error) => eprintln!("phalanx: frame {name} is left out: {error:#}"),
        }
    }
    let used = frames.len();
    ensure!(
        used >= LEAST_FRAMES,
        "{} can be used; at least {LEAST_FRAMES} are needed",
        counted(used, "frame")
    );
    let observations = frames.iter().map(|frame| &frame.estimate.observation);
    let postures = postures::count(observations, refiner.refinement().noise);
    ensure!(
        postures >= LEAST_FRAMES,
        "the {used} frames show {}; at least {LEAST_FRAMES} are needed, for one tells little of a hand's proportions",
        counted(postures, "different posture")
    );
    frames.iter().for_each(Frame::say_doubts);
    check_causes(&frames)?;
    let frames: Vec<BundleFrame> =
        frames.iter().map(|frame| Ok(refiner.frame(&frame.estimate)?)).collect::<Result<_>>()?;
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

/// The names of the frames of the first camera's folder. Of many some are drawn: every n-th of a motion that
/// repeats itself would show one posture.
fn frame_names(folder: &Path, estimator: &Estimator) -> Result<Vec<String>> {
    let folder = folder.join(&estimator.rig().cameras[0].name);
    let name = || folder.display().to_string();
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&folder).with_context(name)? {
        names.push(entry.with_context(name)?.file_name().to_string_lossy().into_owned());
    }
    names.sort_unstable();
    let drawn = random_subset(names.len(), MOST_FRAMES, SUBSET_SEED);
    Ok(drawn.into_iter().map(|k| names[k].clone()).collect())
}

/// One frame as every camera shows it.
struct Frame {
    name: String,
    estimate: Estimate,
    doubts: Vec<ViewDoubt>,
    /// The doubts in words.
    said: Vec<Doubt>,
}

impl Frame {
    fn say_doubts(&self) {
        for doubt in &self.said {
            eprintln!("phalanx: frame {}: {doubt}", self.name);
        }
    }

    /// A doubt that the pictures are what they are taken for.
    fn wrong_input(&self) -> Option<&Doubt> {
        let is_wrong = |doubt: &ViewDoubt| {
            let cause = doubt.cause;
            matches!(cause, Cause::SwappedCamera(_) | Cause::OtherSide | Cause::InvertedMask)
        };
        let wrong = self.doubts.iter().position(is_wrong)?;
        self.said.get(wrong)
    }
}

/// Refuses frames most of which are not what they are taken for.
fn check_causes(frames: &[Frame]) -> Result<()> {
    let wrong: Vec<&Doubt> = frames.iter().filter_map(Frame::wrong_input).collect();
    match wrong.first() {
        Some(first) if 2 * wrong.len() > frames.len() => {
            bail!("{} of {} frames are doubted: {first}", wrong.len(), frames.len())
        }
        _ => Ok(()),
    }
}

/// One frame in every camera: the picture of a name in each camera's folder of a folder.
fn frame((folder, name): (&Path, &str), found: &Pictures, estimator: &Estimator) -> Result<Frame> {
    let mut prepared = Vec::new();
    for camera in &estimator.rig().cameras {
        let picture = input::picture(&folder.join(&camera.name).join(name), None)?;
        prepared.push(found.prepared(&camera.name, &picture)?);
    }
    let pictures: Vec<Picture<'_>> = prepared.iter().map(Prepared::as_picture).collect();
    let mut workspace = Workspace::default();
    let estimate = estimator.estimate(&pictures, &mut workspace)?;
    let doubts = estimator.explain(&pictures, &estimate, &mut workspace)?;
    let not_seen = doubts.iter().find(|doubt| matches!(doubt.cause, Cause::NotSeen(_)));
    if let Some(doubt) = not_seen {
        bail!("camera '{}': {}", estimator.rig().cameras[doubt.view].name, doubt.cause);
    }
    let said = doubts.iter().map(|doubt| Doubt::of_view(estimator, doubt)).collect();
    Ok(Frame { name: name.to_owned(), estimate, doubts, said })
}
