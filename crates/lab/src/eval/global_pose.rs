//! `cargo xtask eval-global`: where hands are and how they are turned, anywhere in the volume.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use comfy_table::{Table, presets};
use phalanx::{Estimator, Framing, OrientationRule, Preset, Progress, Training};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, Pose};

use crate::data::sets::{self, Test};
use crate::eval::held_out::Ground;
use crate::eval::held_out::refined::Starts;
use crate::eval::refining::{Believed, Look, Refining};
use crate::files;
use crate::page::Page;
use crate::progress;
use crate::recipes::trained;

/// How the estimator is learnt.
const PRESET: Preset = Preset::Default;
/// Of so many hands of the test one is looked at.
const EVERY: usize = 5;

#[derive(Args)]
pub struct Arguments {
    /// The rig, TOML; the desk of fixtures/ by default.
    #[arg(long, value_name = "FILE.toml")]
    rig: Option<PathBuf>,
    /// How many hands are learnt from; as many as the default preset asks for by default.
    #[arg(long, value_name = "N", value_parser = sets::samples)]
    samples: Option<usize>,
}

/// The turns of the whole hand, all of which vary in the test.
const TURNS: [Dof; 3] = [Dof::ThetaX, Dof::ThetaY, Dof::ThetaZ];

/// What is wrong with one pose.
struct Errors {
    position_mm: f64,
    /// Of the arm's direction, and of the whole orientation.
    arm_deg: f64,
    orientation_deg: f64,
    theta_z_deg: f64,
    /// Mean over the 20 angles of the digits.
    digits_deg: f64,
    /// Mean over all angles that vary in the test: those of the digits and the turns about three axes.
    active_deg: f64,
}

/// Writes the page and prints it.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let (rig, hand) = (files::rig(arguments.rig.as_deref())?, files::hand(None)?);
    let samples = arguments.samples.unwrap_or(PRESET.scenes());
    let bar = progress::Bar::new();
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header([
        "views",
        "found",
        "",
        "position, mm",
        "arm, °",
        "orientation, °",
        "θ_Z, °",
        "digits, °",
        "all angles, °",
    ]);
    let mut looked_at = 0;
    for views in view_choices(&rig) {
        let (rig, hand) = (rig.select(&views)?, hand.clone());
        let ground = Ground { rig, hand, rule: OrientationRule::default() };
        let estimator = learn(&ground, samples, &bar)?;
        let test = Test::Placed.set(&ground.rig, &ground.hand, &[]);
        let looks = |refining: Refining| refining.looks(&estimator, &test, EVERY, &ground, &bar);
        let of = |looks: &[Option<Look>], pose: fn(&Look) -> &Pose| -> Vec<Errors> {
            looks.iter().flatten().map(|look| Errors::of(pose(look), &look.truth)).collect()
        };
        let found = looks(Refining::whole())?;
        let alone = Refining { starts: Starts::Estimate, ..Refining::whole() };
        let from_truth = looks(Refining { believed: Believed::Truth, ..alone })?;
        looked_at = found.len();
        let views = ground.rig.cameras.len();
        table.add_row(row(views, "estimated", &of(&found, |look| &look.estimate)));
        table.add_row(row(views, "refined", &of(&found, |look| &look.refined)));
        table.add_row(row(views, "the truth, refined", &of(&from_truth, |look| &look.refined)));
    }
    drop(bar);
    let body = format!(
        "Wrists anywhere in the rig's volume, arms leaning by up to 30° in θ_X and in θ_Y, θ_Z from 0° to 90°: every\n\
         {EVERY}th of the test `placed`, {looked_at} hands, those found that every camera shows. The default preset, learnt\n\
         through windows from {samples} scenes. Mean, median and 95th percentile of what is wrong; \"all angles\" are the\n\
         23 that vary, those of the digits and the three turns.\n\
         The truth, refined as if it had been estimated, says where a perfect estimate would lead.\n\n{table}\n",
    );
    let command = format!("cargo xtask eval-global --samples {samples}");
    let page = Page {
        file: "global.md",
        command: &command,
        title: "Where the hand is and how it is turned",
    };
    page.publish(&body)
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

/// An estimator for hands anywhere, that knows how it errs.
fn learn(ground: &Ground, samples: usize, progress: &dyn Progress) -> Result<Estimator> {
    let Ground { rig, hand, .. } = ground;
    let training = Training { framing: Framing::Window, ..PRESET.training() };
    let set = sets::for_preset(training.framing, rig, hand, samples);
    let fresh = sets::fresh_for(training.framing, rig, hand);
    Ok(trained(&training, &set, Some(&fresh), progress)?.estimator)
}

fn row(views: usize, what: &str, errors: &[Errors]) -> Vec<String> {
    let column = |error: fn(&Errors) -> f64| {
        let mut values: Vec<f64> = errors.iter().map(error).collect();
        values.sort_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let at = |share: f64| values[(share * (values.len() - 1) as f64) as usize];
        format!("{mean:.1}, {:.1}, {:.1}", at(0.5), at(0.95))
    };
    vec![
        views.to_string(),
        errors.len().to_string(),
        what.to_owned(),
        column(|e| e.position_mm),
        column(|e| e.arm_deg),
        column(|e| e.orientation_deg),
        column(|e| e.theta_z_deg),
        column(|e| e.digits_deg),
        column(|e| e.active_deg),
    ]
}

impl Errors {
    fn of(found: &Pose, truth: &Pose) -> Self {
        let turn = found.rotation().transpose() * truth.rotation();
        let cosine = 0.5 * (turn.x_axis.x + turn.y_axis.y + turn.z_axis.z - 1.0);
        let arms = found.rotation().z_axis.angle_between(truth.rotation().z_axis);
        let off = |dof: Dof| (found[dof] - truth[dof]).abs().to_degrees();
        let digits: f64 = Dof::ALL.into_iter().filter(|dof| dof.is_internal()).map(off).sum();
        let turns: f64 = TURNS.into_iter().map(off).sum();
        Self {
            position_mm: found.translation().distance(truth.translation()),
            arm_deg: arms.to_degrees(),
            orientation_deg: cosine.clamp(-1.0, 1.0).acos().to_degrees(),
            theta_z_deg: off(Dof::ThetaZ),
            digits_deg: digits / Dof::INTERNAL as f64,
            active_deg: (digits + turns) / (Dof::INTERNAL + TURNS.len()) as f64,
        }
    }
}
