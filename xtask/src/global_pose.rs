//! `cargo xtask eval-global`: where hands are and how they are turned, anywhere in the volume.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use phalanx::{
    Estimator, EvenlySpaced, Framing, Picture, Preset, Progress, Refiner, SceneDescriber, Scenes,
    Shard, Training, Workspace,
};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::Refinement;
use rayon::prelude::*;

use crate::sets::{self, Set, Test};
use crate::{files, progress};

/// How the estimator is learnt.
const PRESET: Preset = Preset::Fast;
/// Hands of the test that are looked at, evenly spaced.
const TESTED: usize = 500;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The rig, TOML; the desk of fixtures/ by default.
    #[arg(long, value_name = "FILE.toml")]
    rig: Option<PathBuf>,
    /// How many hands are learnt from; as many as the fast preset asks for by default.
    #[arg(long, value_name = "N", value_parser = sets::samples)]
    samples: Option<usize>,
}

/// What is wrong with one start.
struct Errors {
    position_mm: f64,
    /// Of the arm's direction, and of the whole orientation.
    arm_deg: f64,
    orientation_deg: f64,
    theta_z_deg: f64,
    /// Mean over the 20 angles of the digits.
    angles_deg: f64,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let (rig, hand) = (files::rig(arguments.rig.as_deref())?, files::hand(None)?);
    let bar = progress::Bar::new();
    let mut report = vec![String::from(
        "Mean, median and 95th percentile of what is wrong before refinement and after.\n\
         views           found  position mm          arm deg              orientation deg      theta_z deg          digits deg\n",
    )];
    for views in view_choices(&rig) {
        let seen = rig.select(&views)?;
        let samples = arguments.samples.unwrap_or(PRESET.scenes());
        let learnt = learn(&seen, &hand, samples, &bar)?;
        let test = Test::Placed.set(&seen, &hand, &[]);
        report.push(rows(&learnt, &test, &bar)?);
    }
    drop(bar);
    files::print(&report.concat())
}

/// All cameras, the first two, and one alone.
fn view_choices(rig: &Rig) -> Vec<Vec<String>> {
    let names: Vec<String> = rig.cameras.iter().map(|camera| camera.name.clone()).collect();
    let middle = names.len() / 2;
    let mut choices = vec![names.clone()];
    if names.len() > 2 {
        choices.push(names[..2].to_vec());
    }
    if names.len() > 1 {
        choices.push(vec![names[middle].clone()]);
    }
    choices
}

/// An estimator for hands anywhere, and what refines its estimates.
fn learn(
    rig: &Rig,
    hand: &HandShape,
    samples: usize,
    progress: &dyn Progress,
) -> Result<(Estimator, Refiner)> {
    let training = Training { framing: Framing::Window, ..PRESET.training() };
    let set = sets::placed(rig, hand, samples);
    let estimator = training.shard(rig, hand, &set, Shard::WHOLE, progress)?.finish()?;
    Ok((estimator, Refiner::new(rig, hand, &set.poses, Refinement::default())?))
}

fn rows(
    (estimator, refiner): &(Estimator, Refiner),
    test: &Set<'_>,
    progress: &dyn Progress,
) -> Result<String> {
    progress.begin("look for hands", TESTED);
    let rig = estimator.rig();
    let describer = SceneDescriber::new(rig, estimator.descriptor().sight())?;
    let some = EvenlySpaced::new(test, TESTED);
    let looks: Vec<Option<[Errors; 2]>> = (0..some.count())
        .into_par_iter()
        .map_init(
            || (describer.clone(), Workspace::default()),
            |(describer, workspace), number| -> Result<_> {
                let scene = some.scene(number);
                let masks = describer.masks(&scene)?;
                let pictures: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
                let found = match estimator.estimate(&pictures, workspace) {
                    Ok(estimate) => {
                        let evidence = refiner.evidence_of(workspace)?;
                        let refined = refiner.refine(&evidence, &estimate)?;
                        let of = |pose: &Pose| Errors::of(pose, &scene.pose);
                        Some([of(&estimate.pose), of(&refined.pose)])
                    }
                    Err(_) => None,
                };
                progress.step();
                Ok(found)
            },
        )
        .collect::<Result<_>>()?;
    let found: Vec<&[Errors; 2]> = looks.iter().flatten().collect();
    let row = |k: usize, what: &str| {
        let column = |error: fn(&Errors) -> f64| {
            let mut values: Vec<f64> = found.iter().map(|both| error(&both[k])).collect();
            values.sort_by(f64::total_cmp);
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let at = |share: f64| values[(share * (values.len() - 1) as f64) as usize];
            format!("  {mean:5.1} {:5.1} {:6.1}", at(0.5), at(0.95))
        };
        format!("{:5}  {what:7}  {:5}", rig.cameras.len(), found.len())
            + &column(|e| e.position_mm)
            + &column(|e| e.arm_deg)
            + &column(|e| e.orientation_deg)
            + &column(|e| e.theta_z_deg)
            + &column(|e| e.angles_deg)
            + "\n"
    };
    Ok(row(0, "start") + &row(1, "refined"))
}

impl Errors {
    fn of(found: &Pose, truth: &Pose) -> Self {
        let turn = found.rotation().transpose() * truth.rotation();
        let cosine = 0.5 * (turn.x_axis.x + turn.y_axis.y + turn.z_axis.z - 1.0);
        let arms = found.rotation().z_axis.angle_between(truth.rotation().z_axis);
        let off = |dof: Dof| (found[dof] - truth[dof]).abs().to_degrees();
        let internal = Dof::ALL.into_iter().filter(|dof| dof.is_internal());
        Self {
            position_mm: found.translation().distance(truth.translation()),
            arm_deg: arms.to_degrees(),
            orientation_deg: cosine.clamp(-1.0, 1.0).acos().to_degrees(),
            theta_z_deg: off(Dof::ThetaZ),
            angles_deg: internal.map(off).sum::<f64>() / Dof::INTERNAL as f64,
        }
    }
}
