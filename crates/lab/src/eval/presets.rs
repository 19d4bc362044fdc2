//! `cargo xtask presets`: what the presets cost and how good they are; writes docs/results/presets.md.

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use comfy_table::{Table, presets};
use phalanx::{Estimator, OrientationRule, Progress};
use phalanx_hand::Pose;

use crate::bench::scale;
use crate::data::sets::Test;
use crate::eval::held_out::Ground;
use crate::eval::held_out::errors::mean_error_deg;
use crate::eval::refining::{Look, Refining};
use crate::files;
use crate::page::Page;
use crate::progress;
use crate::recipes::preset_name::PresetName;

const PAGE: Page<'_> =
    Page { file: "presets.md", command: "cargo xtask presets", title: "The presets" };
const TESTS: [Test; 2] = [Test::Unseen, Test::All];
/// Of so many samples of a test one is looked at; shares no factor with the hands in `all`.
const EVERY: usize = 5;

#[derive(Args)]
pub struct Arguments {
    /// The presets, separated by commas; all by default.
    #[arg(long, value_enum, value_delimiter = ',')]
    presets: Vec<PresetName>,
}

/// Writes the page and prints it.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let ground = Ground {
        rig: files::rig(None)?,
        hand: files::hand(None)?,
        rule: OrientationRule::default(),
    };
    let asked = match arguments.presets.as_slice() {
        [] => PresetName::value_variants(),
        some => some,
    };
    let bar = progress::Bar::new();
    let (mut costs, mut errors) = (Table::new(), Table::new());
    costs.load_style(presets::ASCII_MARKDOWN).set_header([
        "preset",
        "scenes",
        "training",
        "peak memory",
        "estimate, median",
        "95 %",
        "refinement, median",
        "95 %",
        "of `all`, median",
        "95 %",
    ]);
    errors.load_style(presets::ASCII_MARKDOWN).set_header([
        "preset",
        "unseen",
        "unseen, refined",
        "all",
        "all, refined",
    ]);
    for &preset in asked {
        let (cost, error) = rows(preset, &ground, &bar)?;
        costs.add_row(cost);
        errors.add_row(error);
    }
    drop(bar);
    let body = format!(
        "Learnt through three views on {} cores by `cargo xtask train --preset NAME --hypotheses`, each in\n\
         a process of its own. Times of estimates are milliseconds of one thread, from three silhouettes\n\
         of 120×90 to a pose, over every {EVERY}th sample of `unseen`; those of refinement come on top, and\n\
         are longer in `all`, where hand and cameras have to be doubted.\n\n{costs}\n\n\
         Mean absolute error over the 21 active angles, degrees, every {EVERY}th sample of each test; refined\n\
         with the mean hand.\n\n{errors}\n",
        std::thread::available_parallelism().map_or(1, usize::from),
    );
    PAGE.publish(&body)
}

/// A preset's line in the tables of costs and of errors.
fn rows(
    name: PresetName,
    ground: &Ground,
    progress: &dyn Progress,
) -> Result<(Vec<String>, Vec<String>)> {
    let possible = name.to_possible_value().context("presets can be asked for")?;
    let name_of = possible.get_name();
    let model = files::in_repository(&format!("target/presets/{name_of}.phalanx"));
    progress.begin(&format!("learn {name_of}"), 1);
    let (seconds, mebibytes) = scale::train(&["--preset", name_of, "--hypotheses"], &model)?;
    progress.step();
    let estimator = Estimator::from_bytes(&std::fs::read(&model)?)?;
    let mut costs = vec![
        name_of.to_owned(),
        name.preset().scenes().to_string(),
        format!("{seconds:.0} s"),
        format!("{mebibytes:.0} MiB"),
    ];
    let mut errors = vec![name_of.to_owned()];
    for test in TESTS {
        let set = test.set(&ground.rig, &ground.hand, &[]);
        let looks = Refining::whole().looks(&estimator, &set, EVERY, ground, progress)?;
        let looks: Vec<Look> = looks.into_iter().flatten().collect();
        if test == TESTS[0] {
            costs.extend(spread(&looks, |look| look.estimate_ms));
        }
        costs.extend(spread(&looks, |look| look.refine_ms));
        errors.push(mean(&looks, |look| &look.estimate));
        errors.push(mean(&looks, |look| &look.refined));
    }
    Ok((costs, errors))
}

/// The median and the 95th percentile.
fn spread(looks: &[Look], ms: fn(&Look) -> f64) -> [String; 2] {
    let mut sorted: Vec<f64> = looks.iter().map(ms).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share) as usize];
    [0.5, 0.95].map(|share| format!("{:.1} ms", at(share)))
}

fn mean(looks: &[Look], pose: fn(&Look) -> &Pose) -> String {
    let sum: f64 = looks.iter().map(|look| mean_error_deg(pose(look), &look.truth)).sum();
    format!("{:.2}", sum / looks.len() as f64)
}
