//! `cargo xtask eval-subsets`: one model that answers any of its cameras, beside one for just these; writes
//! docs/results/subsets.md.

mod page;

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use phalanx::{Cameras, Estimate, Estimator, Mask, Picture, Progress, Refiner, Trainer, Workspace};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, Pose};
use phalanx_refine::PoseFitSettings;
use rayon::prelude::*;
use serde::Serialize;

use crate::clock::timed;
use crate::data::sets::{self, Test};
use crate::eval::held_out::errors::{active_angles, mean_error_deg};
use crate::eval::seen::Seen;
use crate::files;
use crate::page::Page;
use crate::progress;
use crate::recipes::preset_name::PresetName;

const TESTS: [Test; 2] = [Test::Unseen, Test::All];
/// Of so many samples of a test one is looked at, and one is refined, which takes a hundred times as long; no
/// factor is shared with the hands in `all`.
const EVERY: [(Answer, usize); 2] = [(Answer::Estimated, 3), (Answer::Refined, 75)];
/// How many standard deviations hold these shares of a normal distribution.
const PROMISED: [f64; 2] = [1.0, 1.96];

#[derive(Args)]
pub struct Arguments {
    /// The presets that are learnt by, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "fast")]
    presets: Vec<PresetName>,
    /// How many scenes are learnt from at most; as many as each preset asks for by default.
    #[arg(long, value_name = "N", value_parser = sets::samples)]
    samples: Option<usize>,
    /// Write the figures as JSON, too.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// What is asked for.
#[derive(Clone, Copy, PartialEq, Serialize)]
enum Answer {
    Estimated,
    Refined,
}

/// A model that is asked.
struct Asked<'a> {
    estimator: &'a Estimator,
    refiner: Refiner,
}

/// Some of the cameras on one test.
#[derive(Serialize)]
struct Row {
    preset: String,
    test: &'static str,
    answer: Answer,
    cameras: String,
    /// Of the model of any cameras, and of one for these alone.
    any: Score,
    own: Score,
}

/// How estimates of a test do.
#[derive(Serialize)]
struct Score {
    /// Mean absolute error over the active angles, degrees.
    error_deg: f64,
    /// Mean standard deviation of the active angles, degrees.
    std_deg: f64,
    /// The shares of angles within the deviations that should hold 68 % and 95 %.
    within: [f64; 2],
    /// The share of answers that are doubted.
    doubted: f64,
}

/// What learning takes.
#[derive(Serialize)]
struct Cost {
    preset: String,
    samples: usize,
    /// CPU seconds to learn to answer from all cameras, and from any.
    all_s: f64,
    any_s: f64,
    all_bytes: usize,
    any_bytes: usize,
}

/// What was measured.
#[derive(Default, Serialize)]
struct Figures {
    costs: Vec<Cost>,
    rows: Vec<Row>,
}

/// Writes the page and prints it.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let rig = files::rig(None)?;
    let bar = progress::Bar::new();
    let mut figures = Figures::default();
    for preset in &arguments.presets {
        measure(*preset, arguments.samples, &rig, &mut figures, &bar)?;
    }
    drop(bar);
    if let Some(path) = &arguments.json {
        files::write_whole(path, serde_json::to_string_pretty(&figures)?.as_bytes())?;
    }
    let names: Vec<String> = figures.costs.iter().map(|cost| cost.preset.clone()).collect();
    let samples = arguments.samples.map_or_else(String::new, |n| format!(" --samples {n}"));
    let command = format!("cargo xtask eval-subsets --presets {}{samples}", names.join(","));
    let title = "Some of the cameras";
    Page { file: "subsets.md", command: &command, title }.publish(&page::body(&figures)?)
}

/// Learns by a preset from all cameras and from each subset alone, and tests both.
fn measure(
    name: PresetName,
    samples: Option<usize>,
    rig: &Rig,
    figures: &mut Figures,
    progress: &dyn Progress,
) -> Result<()> {
    let hand = files::hand(None)?;
    let preset =
        name.to_possible_value().context("presets can be asked for")?.get_name().to_owned();
    let asked = name.preset().scenes();
    let samples = samples.map_or(asked, |most| asked.min(most));
    let learn = |rig: &Rig, cameras: Cameras| {
        let trainer = Trainer::preset(name.preset()).samples(samples).answers_from(cameras);
        timed(|| trainer.fit(rig, &hand, progress))
    };
    let (any_s, any) = learn(rig, Cameras::Any)?;
    let (all_s, all) = learn(rig, Cameras::All)?;
    figures.costs.push(Cost {
        preset: preset.clone(),
        samples,
        all_s,
        any_s,
        all_bytes: all.to_bytes()?.len(),
        any_bytes: any.to_bytes()?.len(),
    });
    let mut tests = Vec::new();
    for test in TESTS {
        for (answer, every) in EVERY {
            tests.push((answer, Seen::of(test, (rig, &hand), every, progress)?));
        }
    }
    let of_any = Asked::new(&any)?;
    for views in subsets(rig.cameras.len()) {
        let names: Vec<&str> = views.iter().map(|&view| rig.cameras[view].name.as_str()).collect();
        let own = if views.len() == rig.cameras.len() {
            all.clone()
        } else {
            learn(&rig.select(&names)?, Cameras::All)?.1
        };
        let of_own = Asked::new(&own)?;
        for (answer, seen) in &tests {
            figures.rows.push(Row {
                preset: preset.clone(),
                test: seen.test,
                answer: *answer,
                cameras: names.join(", "),
                any: seen.score(|masks, workspace| {
                    let picture = |view: usize| views.contains(&view).then_some(&masks[view]);
                    let pictures: Vec<Option<Picture<'_>>> =
                        (0..masks.len()).map(|view| picture(view).map(Picture::Mask)).collect();
                    of_any.answer(*answer, &pictures, workspace)
                })?,
                own: seen.score(|masks, workspace| {
                    let pictures: Vec<Picture<'_>> =
                        views.iter().map(|&view| Picture::Mask(&masks[view])).collect();
                    of_own.answer(*answer, &pictures, workspace)
                })?,
            });
        }
    }
    Ok(())
}

impl<'a> Asked<'a> {
    fn new(estimator: &'a Estimator) -> Result<Self> {
        let refiner = Refiner::for_estimator(estimator, PoseFitSettings::of_strangers())?;
        Ok(Self { estimator, refiner })
    }

    fn answer<'p, P>(
        &self,
        answer: Answer,
        pictures: &[P],
        workspace: &mut Workspace,
    ) -> phalanx::Result<Estimate>
    where
        P: Into<Option<Picture<'p>>> + Copy,
    {
        let estimate = self.estimator.estimate(pictures, workspace)?;
        match answer {
            Answer::Estimated => Ok(estimate),
            Answer::Refined => Ok(self.refiner.refine_estimate(self.estimator, estimate)?.refined),
        }
    }
}

/// All subsets of so many cameras, the smaller ones first.
fn subsets(cameras: usize) -> Vec<Vec<usize>> {
    let of = |bits: usize| (0..cameras).filter(|view| bits >> view & 1 == 1).collect();
    let mut subsets: Vec<Vec<usize>> = (1..1 << cameras).map(of).collect();
    subsets.sort_by_key(Vec::len);
    subsets
}

impl Seen {
    fn score(
        &self,
        estimate: impl Fn(&[Mask], &mut Workspace) -> phalanx::Result<Estimate> + Sync,
    ) -> Result<Score> {
        let angles = active_angles();
        let one = |workspace: &mut Workspace, (truth, masks): &(Pose, Vec<Mask>)| {
            let Estimate { pose, std, doubts, .. } = estimate(masks, workspace)?;
            let std = |dof: Dof| std[dof.index()].unwrap_or_default();
            let off = |dof: Dof| (pose[dof] - truth[dof]).abs();
            let share = |deviations: f64| {
                let within = angles.iter().filter(|&&dof| off(dof) <= deviations * std(dof));
                within.count() as f64 / angles.len() as f64
            };
            let mean_std = angles.iter().map(|&dof| std(dof)).sum::<f64>() / angles.len() as f64;
            let [one, two] = PROMISED.map(share);
            let doubted = f64::from(u8::from(!doubts.is_empty()));
            Ok([mean_error_deg(&pose, truth), mean_std.to_degrees(), one, two, doubted])
        };
        let each = self.scenes.par_iter().map_init(Workspace::default, one);
        let each = each.collect::<phalanx::Result<Vec<[f64; 5]>>>()?;
        let mean = |k: usize| each.iter().map(|all| all[k]).sum::<f64>() / each.len() as f64;
        Ok(Score {
            error_deg: mean(0),
            std_deg: mean(1),
            within: [mean(2), mean(3)],
            doubted: mean(4),
        })
    }
}
