//! `cargo xtask eval-held-out`: tests on what was never seen, which the paper did not take.

mod curves;
pub(crate) mod errors;
mod ground;
mod histograms;
pub(crate) mod learner;
mod masks;
pub(crate) mod method;
mod presets;
pub(crate) mod print;
pub(crate) mod refined;
pub(crate) mod row;
mod timing;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use phalanx::{Framing, OrientationRule, Progress};
use phalanx_camera::Rig;
use phalanx_hand::Pose;
use serde::Serialize;

use crate::data::data_set::DataSet;
use crate::data::sets::{self, Augment, Set, Test};
use crate::eval::orientation::Orientation;
use crate::eval::table1::single_view;
use crate::files;
use crate::progress;
use curves::Point;
use learner::{Learner, learn};
use masks::Masks;
use method::Method;
use presets::Learnt;
use row::Row;

pub(crate) use ground::Ground;

/// Samples of the random training sets, unless it is said how many.
pub(crate) const RANDOM_SAMPLES: usize = 5000;

/// What is tested.
#[derive(Args)]
pub struct Arguments {
    /// Learn from this set only. By default from both of the paper's and from `random` poses, clean
    /// and augmented.
    #[arg(long, value_enum)]
    data_set: Option<TrainingSet>,
    /// How many samples the random sets have.
    #[arg(long, value_name = "N", default_value_t = RANDOM_SAMPLES, value_parser = sets::samples)]
    samples: usize,
    /// Damage the samples of `--data-set random`: other hands, moved cameras, ragged silhouettes.
    #[arg(long)]
    augment: bool,
    /// The tests, separated by commas; all by default.
    #[arg(long, value_enum, value_delimiter = ',')]
    tests: Vec<Test>,
    /// The methods, separated by commas; by default those that learn from the paper's descriptors.
    /// The presets, refined or not, learn from scenes of their own, through one view, two and all;
    /// that takes minutes for each.
    #[arg(long, value_enum, value_delimiter = ',')]
    methods: Vec<Method>,
    /// Motion from outside to test on, CSV, degrees; where θ_Z does not vary in it, each pose is
    /// seen at one of the trained angles.
    #[arg(long, value_name = "FILE.csv")]
    poses: Option<PathBuf>,
    /// How many of the rig's cameras the presets look through, numbers separated by commas: 1 (the
    /// top), 2 or all; each of these by default.
    #[arg(long, value_name = "N", value_delimiter = ',', requires = "methods")]
    views: Vec<usize>,
    /// Which way shape contexts are turned.
    #[arg(long, value_enum)]
    orientation: Option<Orientation>,
    /// Folders of silhouettes, one for each camera of the rig and named like it, with the truth in
    /// `poses.csv`, whose column `frame` names the files: the one test then, unless others are
    /// named too.
    #[arg(long, value_name = "DIR")]
    masks: Option<PathBuf>,
    /// The rig, TOML; the desk of fixtures/ by default.
    #[arg(long, value_name = "FILE.toml")]
    rig: Option<PathBuf>,
    /// The hand to learn from, TOML; the mean adult of fixtures/ by default.
    #[arg(long, value_name = "FILE.toml")]
    hand: Option<PathBuf>,
    /// Draw curves instead: error against training samples (500 to 50,000) and against codebook
    /// centres. This takes many minutes.
    #[arg(
        long,
        conflicts_with_all = ["data_set", "samples", "augment", "tests", "methods", "poses", "masks", "timing"]
    )]
    curves: bool,
    /// Add microseconds per estimate, from three silhouettes to a pose, on one thread.
    #[arg(long)]
    timing: bool,
    /// Write the rows as JSON too.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// What can be learnt from.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TrainingSet {
    OpenClose,
    Complex,
    Random,
}

#[derive(Serialize)]
struct Results {
    rows: Vec<Row>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    curves: Vec<Point>,
}

/// Prints the table or the curves; the exit code tells whether every frame of `--masks` is in.
pub(crate) fn run(arguments: &Arguments) -> Result<ExitCode> {
    let ground = Ground {
        rig: files::rig(arguments.rig.as_deref())?,
        hand: files::hand(arguments.hand.as_deref())?,
        rule: arguments.orientation.map_or_else(OrientationRule::default, Orientation::rule),
    };
    let bar = progress::Bar::new();
    let masks =
        arguments.masks.as_deref().map(|folder| Masks::read(folder, &ground)).transpose()?;
    let (text, results) = if arguments.curves {
        let curves = curves::points(&ground, &bar)?;
        (curves::tables(&curves), Results { rows: Vec::new(), curves })
    } else {
        let rows = rows(arguments, &ground, masks.as_ref(), &bar)?;
        (print::tables(&rows), Results { rows, curves: Vec::new() })
    };
    drop(bar);
    files::print(&text)?;
    if let Some(path) = &arguments.json {
        let mut json = serde_json::to_vec_pretty(&results)?;
        json.push(b'\n');
        files::write_whole(path, &json)?;
    }
    let complete = masks.is_none_or(|masks| masks.left_out == 0);
    Ok(if complete { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn rows(
    arguments: &Arguments,
    ground: &Ground,
    masks: Option<&Masks>,
    progress: &dyn Progress,
) -> Result<Vec<Row>> {
    let motion = arguments.poses.as_deref().map(files::poses).transpose()?;
    let motion = motion.map_or_else(Vec::new, |table| table.poses);
    let (sets, tests) = (training_sets(arguments, ground)?, tests(arguments)?);
    let methods = methods(arguments);
    let presets: Vec<_> = methods.iter().filter_map(|method| method.preset()).collect();
    let placed = presets.clone();
    let counts = presets::view_counts(ground);
    ensure!(
        arguments.views.iter().all(|count| counts.contains(count)),
        "--views takes some of {counts:?} for this rig"
    );
    let methods = methods.into_iter().filter(|method| method.preset().is_none()).collect();
    let protocol = Protocol { ground, methods, tests, motion: &motion };
    let (learners, mut rows) = protocol.run(&sets, progress)?;
    let pictures = protocol.tests.iter().any(|test| *test != Test::Placed) || masks.is_some();
    let presets = if pictures { presets } else { Vec::new() };
    let learnt = presets::learn(&presets, Framing::Picture, &arguments.views, ground, progress)?;
    rows.extend(protocol.test_presets(&learnt, progress)?);
    if protocol.tests.contains(&Test::Placed) {
        let learnt = presets::learn(&placed, Framing::Window, &arguments.views, ground, progress)?;
        let set = Test::Placed.set(&ground.rig, &ground.hand, &motion);
        rows.extend(presets::test(&set, &learnt, ground, progress)?);
    }
    if let Some(masks) = masks {
        rows.extend(masks.test(&learners, ground)?);
        rows.extend(masks.test_presets(&learnt, ground)?);
    }
    if arguments.timing {
        timing::add(&mut rows, &learners, ground)?;
    }
    Ok(rows)
}

/// What is compared, and on what.
pub(crate) struct Protocol<'a> {
    pub(crate) ground: &'a Ground,
    pub(crate) methods: Vec<Method>,
    pub(crate) tests: Vec<Test>,
    /// For [`Test::Poses`].
    pub(crate) motion: &'a [Pose],
}

impl Protocol<'_> {
    /// Learns from every set through one view and through all, and takes every test.
    pub(crate) fn run(
        &self,
        sets: &[Set<'_>],
        progress: &dyn Progress,
    ) -> Result<(Vec<Learner>, Vec<Row>)> {
        let Self { ground, methods, tests, motion } = self;
        let views = views(&ground.rig);
        let mut learners = Vec::new();
        for set in sets.iter().filter(|_| !methods.is_empty()) {
            learners.extend(learn(set, &views, ground.rule, methods, progress)?);
        }
        let mut rows = Vec::new();
        for test in tests.iter().filter(|_| !learners.is_empty()) {
            let set = test.set(&ground.rig, &ground.hand, motion);
            rows.extend(row::of_set(&set, &learners, ground, progress)?);
        }
        Ok((learners, rows))
    }

    /// Takes every test with presets.
    fn test_presets(&self, learnt: &[Learnt], progress: &dyn Progress) -> Result<Vec<Row>> {
        let Self { ground, tests, motion, .. } = self;
        let mut rows = Vec::new();
        // Those who look at whole pictures expect the hand in their middle.
        for test in tests.iter().filter(|&&test| test != Test::Placed && !learnt.is_empty()) {
            let set = test.set(&ground.rig, &ground.hand, motion);
            rows.extend(presets::test(&set, learnt, ground, progress)?);
        }
        Ok(rows)
    }
}

/// One view (the top, or the first of a rig without one), then all.
fn views(rig: &Rig) -> Vec<Vec<usize>> {
    let single = single_view(rig).unwrap_or(0);
    let all: Vec<usize> = (0..rig.cameras.len()).collect();
    if all.len() == 1 { vec![all] } else { vec![vec![single], all] }
}

fn training_sets<'a>(arguments: &Arguments, ground: &'a Ground) -> Result<Vec<Set<'a>>> {
    let Ground { rig, hand, .. } = ground;
    let random = |augment| sets::random(rig, hand, arguments.samples, augment);
    ensure!(
        !arguments.augment || arguments.data_set == Some(TrainingSet::Random),
        "--augment goes with --data-set random"
    );
    Ok(match arguments.data_set {
        Some(TrainingSet::OpenClose) => vec![stored("open-close", ground)?],
        Some(TrainingSet::Complex) => vec![stored("complex", ground)?],
        Some(TrainingSet::Random) if arguments.augment => vec![random(Augment::Yes)],
        Some(TrainingSet::Random) => vec![random(Augment::No)],
        None => all_training_sets(ground, arguments.samples)?,
    })
}

/// Everything that can be learnt from, the random sets of so many samples.
pub(crate) fn all_training_sets(ground: &Ground, samples: usize) -> Result<Vec<Set<'_>>> {
    let random = |augment| sets::random(&ground.rig, &ground.hand, samples, augment);
    let (open_close, complex) = (stored("open-close", ground)?, stored("complex", ground)?);
    Ok(vec![open_close, complex, random(Augment::No), random(Augment::Yes)])
}

fn stored<'a>(name: &'static str, ground: &'a Ground) -> Result<Set<'a>> {
    Ok(sets::clean(name, &ground.rig, &ground.hand, DataSet::stored(name)?.poses))
}

fn methods(arguments: &Arguments) -> Vec<Method> {
    if !arguments.methods.is_empty() {
        return arguments.methods.clone();
    }
    Method::OF_DESCRIPTORS.to_vec()
}

/// The synthetic tests. `poses` is one of them where there is motion from outside.
fn tests(arguments: &Arguments) -> Result<Vec<Test>> {
    let outside = arguments.poses.is_some();
    ensure!(
        outside || !arguments.tests.contains(&Test::Poses),
        "the test 'poses' needs motion: --poses FILE.csv"
    );
    if !arguments.tests.is_empty() {
        let mut tests = arguments.tests.clone();
        if outside && !tests.contains(&Test::Poses) {
            tests.push(Test::Poses);
        }
        return Ok(tests);
    }
    if arguments.masks.is_some() {
        return Ok(if outside { vec![Test::Poses] } else { Vec::new() });
    }
    let last = outside.then_some(Test::Poses);
    Ok(Test::SYNTHETIC.into_iter().chain(last).collect())
}
