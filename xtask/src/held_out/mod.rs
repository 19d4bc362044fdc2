//! `cargo xtask eval-held-out`: tests on what was never seen, which the paper did not take.

mod learner;
mod method;
mod print;
mod row;
mod sets;

use std::path::PathBuf;

use anyhow::Result;
use clap::{Args, ValueEnum};
use phalanx::{OrientationRule, Progress};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use serde::Serialize;

use crate::data_set::DataSet;
use crate::table1::single_view;
use crate::{files, progress};
use learner::{Learner, describe, learn};
use method::Method;
use row::Row;
use sets::{Augment, Set, Test};

/// Samples of the random training sets, unless it is said how many.
const RANDOM_SAMPLES: usize = 5000;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Learn from this set only. By default from `complex` and from `random` poses, clean and
    /// augmented.
    #[arg(long, value_enum)]
    data_set: Option<TrainingSet>,
    /// How many samples the random sets have.
    #[arg(long, value_name = "N", default_value_t = RANDOM_SAMPLES)]
    samples: usize,
    /// Damage the samples of `--data-set random`: other hands, moved cameras, ragged silhouettes.
    #[arg(long)]
    augment: bool,
    /// The tests, separated by commas; all by default.
    #[arg(long, value_enum, value_delimiter = ',')]
    tests: Vec<Test>,
    /// The methods, separated by commas; all by default.
    #[arg(long, value_enum, value_delimiter = ',')]
    methods: Vec<Method>,
    /// Motion from outside to test on, CSV, degrees; where θ_Z does not vary in it, each pose is
    /// seen at one of the trained angles.
    #[arg(long, value_name = "FILE.csv")]
    poses: Option<PathBuf>,
    /// Which way shape contexts are turned.
    #[arg(long, value_enum, default_value_t)]
    orientation: crate::orientation::Rule,
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
struct Table {
    rows: Vec<Row>,
}
