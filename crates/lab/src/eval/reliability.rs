//! `cargo xtask reliability`: how often the truth is as near as deviations promise, and how large they are;
//! writes docs/results/reliability.md and its plot.

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use comfy_table::{Table, presets};
use phalanx::{Estimate, Mask, Picture, Refiner, Trainer, Workspace};
use phalanx_camera::Camera;
use phalanx_hand::{Dof, Pose};
use phalanx_refine::PoseFitSettings;
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
/// Cameras of the desk that refined ones are looked at by, the last of all.
const REFINED_VIEWS: [&[&str]; 3] = [&["top"], &["side", "top"], &["side", "top", "other_side"]];
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

/// An error beyond so many deviations was as good as excluded.
const EXCLUDED: f64 = 8.0;

/// What was found of one kind of test.
struct Found {
    name: String,
    /// Whether all cameras looked on.
    is_of_all: bool,
    /// A share for each that is promised.
    shares: Vec<f64>,
    /// The share of errors within the interval that should hold 95 %.
    within_interval: f64,
    /// Of a thousand errors, those beyond [`EXCLUDED`].
    excluded: f64,
    /// Means of errors, deviations and halves of intervals, degrees.
    error_deg: f64,
    std_deg: f64,
    interval_deg: f64,
    /// The share of fits that converged; `None` of estimates.
    converged: Option<f64>,
}

/// An answer, and whether its fit converged, if it is of one.
type Answer = (Estimate, Option<bool>);

/// One angle of one scene, radians.
struct Angle {
    error: f64,
    std: f64,
    interval: f64,
}

/// Writes the page and its plot, and prints the page.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let (rig, hand) = (files::rig(None)?, files::hand(None)?);
    let preset = arguments.preset.preset();
    let samples = arguments.samples.unwrap_or(preset.scenes());
    let bar = progress::Bar::new();
    let estimator = Trainer::preset(preset).samples(samples).fit(&rig, &hand, &bar)?;
    let refinement = PoseFitSettings::of_strangers();
    let refiner = Refiner::for_estimator(&estimator, refinement)?;
    let mut found = Vec::new();
    for test in ESTIMATED {
        let seen = Seen::of(test, (&rig, &hand), EVERY[0], &bar)?;
        found.push(Found::of(seen.test.to_owned(), &seen, &|masks, workspace| {
            let pictures: Vec<Picture<'_>> = masks.iter().map(Picture::Mask).collect();
            Ok((estimator.estimate(&pictures, workspace)?, None))
        })?);
    }
    for test in REFINED {
        let seen = Seen::of(test, (&rig, &hand), EVERY[1], &bar)?;
        for views in REFINED_VIEWS {
            let is_used = |camera: &Camera| views.contains(&camera.name.as_str());
            let used: Vec<bool> = rig.cameras.iter().map(is_used).collect();
            let of_views = Found::of(name(seen.test, views), &seen, &|masks, workspace| {
                let picture = |(mask, &used): (_, &bool)| used.then_some(Picture::Mask(mask));
                let pictures: Vec<_> = masks.iter().zip(&used).map(picture).collect();
                let estimate = estimator.estimate(&pictures, workspace)?;
                let refined = refiner.refine_estimate(&estimator, estimate)?;
                Ok((refined.refined, Some(refined.fit.converged)))
            })?;
            let is_of_all = views.len() == rig.cameras.len();
            found.push(Found { is_of_all, ..of_views });
        }
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

/// How a kind of refined estimates is called.
fn name(test: &str, views: &[&str]) -> String {
    match views.len() {
        1 => format!("{test}, refined, 1 view"),
        3 => format!("{test}, refined"),
        some => format!("{test}, refined, {some} views"),
    }
}

impl Found {
    fn of(
        name: String,
        seen: &Seen,
        look: &(impl Fn(&[Mask], &mut Workspace) -> Result<Answer> + Sync),
    ) -> Result<Self> {
        let angles = active_angles();
        let compare = |workspace: &mut Workspace, (truth, masks): &(Pose, Vec<Mask>)| {
            let (estimate, converged) = look(masks, workspace)?;
            let angle = |&dof: &Dof| {
                let error = (estimate.pose[dof] - truth[dof]).abs();
                let (std, interval) = estimate.std[dof.index()].zip(estimate.interval(dof))?;
                Some(Angle { error, std, interval })
            };
            Ok((angles.iter().filter_map(angle).collect(), converged))
        };
        let all = seen.scenes.par_iter().map_init(Workspace::default, compare);
        let (all, converged): (Vec<Vec<Angle>>, Vec<Option<bool>>) =
            all.collect::<Result<Vec<_>>>()?.into_iter().unzip();
        let all: Vec<Angle> = all.into_iter().flatten().collect();
        let converged: Option<Vec<bool>> = converged.into_iter().collect();
        let mean = |of: &dyn Fn(&Angle) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        let share =
            |holds: &dyn Fn(&Angle) -> bool| mean(&|angle| f64::from(u8::from(holds(angle))));
        let within = |(_, deviations)| share(&|angle| angle.error <= deviations * angle.std);
        Ok(Self {
            name,
            is_of_all: true,
            shares: PROMISED.map(within).to_vec(),
            within_interval: share(&|angle| angle.error <= angle.interval),
            excluded: 1e3 * share(&|angle| angle.error > EXCLUDED * angle.std),
            error_deg: mean(&|angle| angle.error).to_degrees(),
            std_deg: mean(&|angle| angle.std).to_degrees(),
            interval_deg: mean(&|angle| angle.interval).to_degrees(),
            converged: converged.map(|fits| {
                fits.iter().filter(|converged| **converged).count() as f64 / fits.len() as f64
            }),
        })
    }
}

/// Found against promised shares of all cameras together, and what would be right: more lines would hide each
/// other.
fn chart(found: &[Found]) -> Chart {
    let percent = |share: f64| 100.0 * share;
    let promised = PROMISED.map(|(share, _)| percent(share));
    let as_promised = promised.map(|share| (share, share)).to_vec();
    let curve = |found: &Found| {
        let shares = found.shares.iter().map(|&share| percent(share));
        Series::new(&found.name, Mark::LineAndDots, promised.into_iter().zip(shares).collect())
    };
    let of_all = found.iter().filter(|found| found.is_of_all);
    let series = of_all.map(curve).chain([Series::new("as promised", Mark::Line, as_promised)]);
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
    for Found { name, shares, .. } in found {
        let shares = shares.iter().map(|&share| percent(share));
        table.add_row([name.clone()].into_iter().chain(shares));
    }
    let mut sizes = Table::new();
    sizes.load_style(presets::ASCII_MARKDOWN).set_header([
        "",
        "error",
        "deviation",
        "half of the 95 % interval",
        "within it",
        "beyond 8 deviations, of 1,000",
        "fits converged",
    ]);
    for found in found {
        sizes.add_row([
            found.name.clone(),
            format!("{:.2}°", found.error_deg),
            format!("{:.2}°", found.std_deg),
            format!("{:.2}°", found.interval_deg),
            percent(found.within_interval),
            format!("{:.1}", found.excluded),
            found.converged.map_or_else(|| "–".to_owned(), percent),
        ]);
    }
    format!(
        "The shares of the 21 active angles whose truth is within as many standard deviations as hold the promised share\n\
         of a normal distribution, by kind of test; three views, learnt from {samples} scenes. Above the line deviations\n\
         are larger than they need be, below it they are too small.\n\n\
         ![{}](reliability.svg)\n\n{table}\n\n\
         How large errors and deviations are, means. Refined deviations join what the curvature of the fit and other postures\n\
         of the digits say, and are scaled by what drawn scenes say, of strange hands before turned cameras with ragged borders\n\
         and of the hand as given; where tails are heavy, the interval that holds 95 % is wider than 1.96 deviations. Errors\n\
         beyond eight of them are of fingers that were fitted in another posture, or one for another: the silhouettes are\n\
         explained as well as by the truth, or nearly so.\n\n\
         {sizes}\n",
        chart(found).words()
    )
}
