//! `cargo xtask ablation`: what each part of the default preset and of refinement gives.

use anyhow::Result;
use clap::Args;
use comfy_table::{Table, presets};
use phalanx::{
    Encoding, Estimator, Framing, OrientationRule, Preset, Progress, RegressorConfig, Training,
};
use phalanx_hand::Pose;
use phalanx_refine::{NuisanceParameters, PoseFitSettings};

use crate::data::sets::{self, Augment, Set, Test};
use crate::eval::held_out::Ground;
use crate::eval::held_out::errors::mean_error_deg;
use crate::eval::held_out::refined::Starts;
use crate::eval::refining::{Hand, Look, Refining};
use crate::files;
use crate::page::Page;
use crate::progress;
use crate::recipes::trained;

const PRESET: Preset = Preset::Default;
const TESTS: [Test; 2] = [Test::Unseen, Test::All];
/// Of so many samples of a test one is looked at; shares no factor with the hands in `all`.
const EVERY: usize = 17;
/// Scenes that are learnt from where there are few.
const FEW: usize = 2000;

#[derive(Args)]
pub struct Arguments {
    /// How many scenes are learnt from; those of the preset by default.
    #[arg(long, value_name = "N", value_parser = sets::samples)]
    samples: Option<usize>,
}

/// How an estimator is learnt.
struct Learning {
    training: Training,
    scenes: usize,
    augment: Augment,
}

/// Mean errors over the active angles in a test, degrees.
struct Errors {
    estimated: f64,
    refined: f64,
}

/// Writes the page and prints it.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let ground = Ground {
        rig: files::rig(None)?,
        hand: files::hand(None)?,
        rule: OrientationRule::default(),
    };
    let bar = progress::Bar::new();
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header([
        "",
        "unseen",
        "unseen, refined",
        "all",
        "all, refined",
    ]);
    let mut push = |name: &str, estimator: &Estimator, refining: &Refining| -> Result<()> {
        let mut row = vec![name.to_owned()];
        for test in TESTS {
            let set = test.set(&ground.rig, &ground.hand, &[]);
            let errors = errors(estimator, refining, &set, &ground, &bar)?;
            row.extend([errors.estimated, errors.refined].map(|error| format!("{error:.2}")));
        }
        table.add_row(row);
        Ok(())
    };
    let whole = Refining::whole();
    let samples = arguments.samples.unwrap_or(PRESET.scenes());
    let estimator = Learning::of(samples).run(&ground, &bar)?;
    push("the default preset, refined with the mean hand", &estimator, &whole)?;
    for (name, refining) in refinings() {
        push(name, &estimator, &refining)?;
    }
    for (name, learning) in learnings(samples) {
        push(name, &learning.run(&ground, &bar)?, &whole)?;
    }
    drop(bar);
    let body = format!(
        "Mean absolute error over the 21 active angles,\n\
         degrees, three views, every {EVERY}th sample of each test. Each line changes one thing of the first.\n\
         All but the one of few scenes learn from {samples}, the preset by itself from {}.\n\n{table}\n",
        PRESET.scenes(),
    );
    let command = format!("cargo xtask ablation --samples {samples}");
    let page = Page { file: "ablation.md", command: &command, title: "What each part gives" };
    page.publish(&body)
}

/// What is changed in refining.
fn refinings() -> Vec<(&'static str, Refining)> {
    let whole = Refining::whole();
    let Refining { refinement, .. } = &whole;
    let with = |refinement: PoseFitSettings| Refining { refinement, ..whole.clone() };
    let no_cameras =
        refinement.nuisance.map(|nuisance| NuisanceParameters { cameras: None, ..nuisance });
    let one_level = refinement.levels.last().copied().into_iter().collect();
    vec![
        ("the hand calibrated", Refining { hand: Hand::Calibrated, ..whole.clone() }),
        ("one hypothesis", Refining { starts: Starts::Estimate, ..whole.clone() }),
        ("no search of postures", with(PoseFitSettings { max_restarts: 0, ..refinement.clone() })),
        (
            "no doubt of hand or cameras",
            with(PoseFitSettings { nuisance: None, ..refinement.clone() }),
        ),
        (
            "no doubt of the cameras",
            with(PoseFitSettings { nuisance: no_cameras, ..refinement.clone() }),
        ),
        ("no margins", with(PoseFitSettings { margin: 1e-3, ..refinement.clone() })),
        ("at once fine", with(PoseFitSettings { levels: one_level, ..refinement.clone() })),
    ]
}

/// What is changed in learning.
fn learnings(samples: usize) -> Vec<(&'static str, Learning)> {
    let whole = || Learning::of(samples);
    let training = |change: fn(&mut Training)| {
        let mut learning = whole();
        change(&mut learning.training);
        learning
    };
    vec![
        ("few scenes: 2,000", Learning { scenes: FEW, ..whole() }),
        ("clean scenes", Learning { augment: Augment::No, ..whole() }),
        ("coding by counts", training(|own| own.encoding = Encoding::SoftHistogram)),
        (
            "800 Gaussians, a distance for each digit",
            training(|own| own.regressor = Preset::Fast.training().regressor),
        ),
        (
            "2,000 Gaussians, one distance for all",
            training(|own| {
                if let RegressorConfig::LearntMetric(own_distances) =
                    Preset::Fast.training().regressor
                {
                    own.regressor = RegressorConfig::Nystrom(own_distances.regression);
                }
            }),
        ),
        ("through windows", training(|own| own.framing = Framing::Window)),
    ]
}

impl Learning {
    /// As the preset does, from so many scenes.
    fn of(scenes: usize) -> Self {
        Self { training: PRESET.training(), scenes, augment: Augment::Yes }
    }

    fn run(&self, ground: &Ground, progress: &dyn Progress) -> Result<Estimator> {
        let Ground { rig, hand, .. } = ground;
        let set = sets::random(rig, hand, self.scenes, self.augment);
        let fresh = sets::fresh(rig, hand, sets::ERROR_SCENES, self.augment);
        Ok(trained(&self.training, &set, Some(&fresh), progress)?.estimator)
    }
}

fn errors(
    estimator: &Estimator,
    refining: &Refining,
    set: &Set<'_>,
    ground: &Ground,
    progress: &dyn Progress,
) -> Result<Errors> {
    let looks = refining.looks(estimator, set, EVERY, ground, progress)?;
    let looks: Vec<Look> = looks.into_iter().flatten().collect();
    let mean = |pose: fn(&Look) -> &Pose| {
        let errors = looks.iter().map(|look| mean_error_deg(pose(look), &look.truth));
        errors.sum::<f64>() / looks.len() as f64
    };
    Ok(Errors { estimated: mean(|look| &look.estimate), refined: mean(|look| &look.refined) })
}
