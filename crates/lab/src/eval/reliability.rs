//! `cargo xtask reliability`: how often the truth is as near as deviations promise; writes
//! docs/results/reliability.md and its plot.

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use comfy_table::{Table, presets};
use phalanx::{Estimate, Estimator, Mask, Picture, Refiner, Trainer, Workspace};
use phalanx_hand::Pose;
use phalanx_refine::{NuisanceParameters, PoseFitSettings};
use rayon::prelude::*;

use crate::data::sets::{self, Test};
use crate::eval::held_out::errors::active_angles;
use crate::eval::seen::Seen;
use crate::figures::chart::{Axis, Chart, Mark, Series};
use crate::files;
use crate::page::Page;
use crate::progress;
use crate::recipes::preset_name::PresetName;

/// Tests of estimates, and of refined ones, which take a hundred times as long.
const ESTIMATED: [Test; 4] = [Test::Unseen, Test::Random, Test::Hands, Test::All];
const REFINED: [Test; 2] = [Test::Unseen, Test::All];
/// Of so many samples of a test one is looked at; no factor is shared with the hands of a test.
const EVERY: [usize; 2] = [3, 25];

/// Shares of a normal distribution, and within how many deviations they are.
const PROMISED: [(f64, f64); 9] = [
    (0.1, 0.1257),
    (0.25, 0.3186),
    (0.4, 0.5244),
    (0.5, 0.6745),
    (0.6827, 1.0),
    (0.8, 1.2816),
    (0.9, 1.6449),
    (0.95, 1.96),
    (0.99, 2.5758),
];

#[derive(Args)]
pub struct Arguments {
    /// The preset that is learnt by.
    #[arg(long, value_enum, default_value = "fast")]
    preset: PresetName,
    /// How many scenes are learnt from; as many as the preset asks for by default.
    #[arg(long, value_name = "N", value_parser = sets::samples)]
    samples: Option<usize>,
}

/// What was found of one kind of test: a share for each that is promised.
struct Found {
    name: String,
    shares: Vec<f64>,
}

/// Writes the page and its plot, and prints the page.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let (rig, hand) = (files::rig(None)?, files::hand(None)?);
    let preset = arguments.preset.preset();
    let samples = arguments.samples.unwrap_or(preset.scenes());
    let bar = progress::Bar::new();
    let estimator = Trainer::preset(preset).samples(samples).fit(&rig, &hand, &bar)?;
    let refinement = PoseFitSettings {
        nuisance: Some(NuisanceParameters::default()),
        ..PoseFitSettings::default()
    };
    let refiner = Refiner::for_estimator(&estimator, refinement)?;
    let mut found = Vec::new();
    for test in ESTIMATED {
        let seen = Seen::of(test, (&rig, &hand), EVERY[0], &bar)?;
        found.push(Found::of(seen.test.to_owned(), &seen, &estimator, Ok)?);
    }
    for test in REFINED {
        let seen = Seen::of(test, (&rig, &hand), EVERY[1], &bar)?;
        let refine = |estimate| Ok(refiner.refine_estimate(&estimator, estimate)?.refined);
        found.push(Found::of(format!("{}, refined", seen.test), &seen, &estimator, refine)?);
    }
    drop(bar);
    let plot = files::in_repository("docs/results/reliability.svg");
    files::write_whole(&plot, chart(&found).svg()?.as_bytes())?;
    let name = arguments.preset.to_possible_value().context("presets can be asked for")?;
    let command =
        format!("cargo xtask reliability --preset {} --samples {samples}", name.get_name());
    let title = "What deviations promise";
    Page { file: "reliability.md", command: &command, title }.publish(&body(&found, samples))
}

impl Found {
    fn of(
        name: String,
        seen: &Seen,
        estimator: &Estimator,
        further: impl Fn(Estimate) -> Result<Estimate> + Sync,
    ) -> Result<Self> {
        let angles = active_angles();
        let off = |workspace: &mut Workspace, (truth, masks): &(Pose, Vec<Mask>)| {
            let pictures: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
            let Estimate { pose, std, .. } = further(estimator.estimate(&pictures, workspace)?)?;
            let deviations = angles
                .iter()
                .filter_map(|&dof| Some((pose[dof] - truth[dof]).abs() / std[dof.index()]?));
            Ok(deviations.collect::<Vec<f64>>())
        };
        let all = seen.scenes.par_iter().map_init(Workspace::default, off);
        let all = all.collect::<Result<Vec<_>>>()?.concat();
        let within = |(_, deviations): (f64, f64)| {
            all.iter().filter(|&&off| off <= deviations).count() as f64 / all.len() as f64
        };
        Ok(Self { name, shares: PROMISED.map(within).to_vec() })
    }
}

/// Found against promised shares, and what would be right.
fn chart(found: &[Found]) -> Chart {
    let percent = |share: f64| 100.0 * share;
    let promised = PROMISED.map(|(share, _)| percent(share));
    let as_promised = promised.map(|share| (share, share)).to_vec();
    let curve = |found: &Found| {
        let shares = found.shares.iter().map(|&share| percent(share));
        Series::new(&found.name, Mark::LineAndDots, promised.into_iter().zip(shares).collect())
    };
    let series =
        found.iter().map(curve).chain([Series::new("as promised", Mark::Line, as_promised)]);
    Chart {
        x: Axis::from_zero("promised, %"),
        y: Axis::from_zero("found, %"),
        series: series.collect(),
    }
}

fn body(found: &[Found], samples: usize) -> String {
    let mut table = Table::new();
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let promised = PROMISED.map(|(share, _)| percent(share));
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_header(["promised".to_owned()].into_iter().chain(promised));
    for Found { name, shares } in found {
        let shares = shares.iter().map(|&share| percent(share));
        table.add_row([name.clone()].into_iter().chain(shares));
    }
    format!(
        "The shares of the 21 active angles whose truth is within as many standard deviations as hold the promised share\n\
         of a normal distribution, by kind of test; three views, learnt from {samples} scenes. Above the line deviations\n\
         are larger than they need be, below it they are too small.\n\n\
         ![{}](reliability.svg)\n\n{table}\n",
        chart(found).words()
    )
}
