//! `cargo xtask eval-table1`: the paper's Table 1 (§ 5.2) on our data.

mod job;
mod method;
mod paper;
mod print;
mod row;
mod trial;

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use phalanx::Progress;
use phalanx_camera::Rig;
use rayon::prelude::*;
use serde::Serialize;

use crate::data::data_set::DataSet;
use crate::data::described::Described;
use crate::files;
use crate::metrics::AngleErrors;
use crate::progress;
use job::{Job, counts, jobs};
use method::Method;
use trial::Outcome;

pub(crate) use method::{Counts as PaperCounts, Method as TableMethod};
pub(crate) use print::{HEADER, legend, lines};
pub(crate) use row::{Row, SPLITS};

/// The camera of the single-view rows.
const SINGLE_VIEW: &str = "top";
/// What is tested.
#[derive(Args)]
pub struct Arguments {
    /// A trajectory to evaluate in place of ours: CSV, degrees; where θ_Z does not vary in it,
    /// each pose is repeated at seven angles from 0° to 90°.
    #[arg(long, value_name = "FILE.csv")]
    poses: Option<PathBuf>,
    /// Write the rows as JSON too.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

#[derive(Serialize)]
struct Table {
    rows: Vec<Row>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let data_sets = match &arguments.poses {
        Some(path) => vec![DataSet::from_file("poses", path)?],
        None => vec![DataSet::stored("open-close")?, DataSet::stored("complex")?],
    };
    let (rig, hand, bar) = (files::rig(None)?, files::hand(None)?, progress::Bar::new());
    let mut rows = Vec::new();
    let views = [vec![single_view(&rig)?], (0..rig.cameras.len()).collect()];
    for data_set in data_sets {
        let described = data_set.describe(&rig, &hand, &bar)?;
        rows.extend(evaluate(&described, &views, &bar)?);
    }
    drop(bar);
    print::print(&rows)?;
    let table = Table { rows };
    if let Some(path) = &arguments.json {
        let mut json = serde_json::to_vec_pretty(&table)?;
        json.push(b'\n');
        files::write_whole(path, &json)?;
    }
    Ok(())
}

/// The camera of the single-view rows, by its number.
pub(crate) fn single_view(rig: &Rig) -> Result<usize> {
    let single = rig.cameras.iter().position(|camera| camera.name == SINGLE_VIEW);
    single.with_context(|| format!("the rig has no camera '{SINGLE_VIEW}'"))
}

/// All rows of one data set, for one choice of cameras after the other.
pub(crate) fn evaluate(
    data_set: &Described,
    views: &[Vec<usize>],
    progress: &dyn Progress,
) -> Result<Vec<Row>> {
    let most_views = views.iter().map(Vec::len).max().unwrap_or(0);
    run_jobs(data_set, views, |count| jobs(data_set, count, most_views), progress)
}

/// The rows of the selecting methods at the counts of `counted_as` views, for one choice of
/// cameras after the other.
pub(crate) fn evaluate_equally(
    data_set: &Described,
    views: &[Vec<usize>],
    counted_as: usize,
    progress: &dyn Progress,
) -> Result<Vec<Row>> {
    let counts = counts(data_set, counted_as);
    let job = |method| Job { method, counts, rows: vec!["equal"] };
    run_jobs(data_set, views, |_| Method::COUNTED.map(job).into(), progress)
}

/// The rows of the jobs of each number of views.
fn run_jobs(
    data_set: &Described,
    views: &[Vec<usize>],
    jobs: impl Fn(usize) -> Vec<Job> + Sync,
    progress: &dyn Progress,
) -> Result<Vec<Row>> {
    let runs: Vec<(&[usize], u64)> =
        views.iter().flat_map(|v| (0..SPLITS).map(move |split| (v.as_slice(), split))).collect();
    progress.begin("split, cluster, fit, test", runs.len());
    let trials: Vec<Result<Vec<(Job, Outcome)>>> = runs
        .par_iter()
        .map(|&(views, split)| {
            let halves = data_set.halves(views, split)?;
            let outcomes = trial::run(&halves, &data_set.active, &jobs(views.len()));
            progress.step();
            outcomes
        })
        .collect();
    let trials = trials.into_iter().collect::<Result<Vec<_>>>()?;
    let per_views = trials.chunks(SPLITS as usize).zip(views);
    Ok(per_views.flat_map(|(trials, views)| rows(&data_set.name, views.len(), trials)).collect())
}

/// The rows of one number of views: each job's mean over the splits.
fn rows(data_set: &str, views: usize, trials: &[Vec<(Job, Outcome)>]) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for (k, (job, first)) in trials[0].iter().enumerate() {
        let of_job = || trials.iter().map(|trial| &trial[k].1);
        let errors = AngleErrors::average(&of_job().map(|o| o.errors.clone()).collect::<Vec<_>>());
        let mean_count = |count: fn(&Outcome) -> usize| {
            let total: usize = of_job().map(count).sum();
            (total + trials.len() / 2) / trials.len()
        };
        let (worst_dof, worst_deg) = errors.worst();
        rows.extend(job.rows.iter().map(|&counts| Row {
            views,
            data_set: data_set.to_owned(),
            kernels: job.method.name(),
            counts,
            selected_features: mean_count(|o| o.selected_features),
            selected_samples: mean_count(|o| o.selected_samples),
            train_samples: first.train_samples,
            test_samples: first.test_samples,
            mae_deg: errors.mae(),
            std_deg: errors.std(),
            worst_deg,
            worst_dof: worst_dof.name(),
            mean_predictor_mae_deg: of_job().map(|o| o.mean_predictor_mae_deg).sum::<f64>()
                / trials.len() as f64,
            paper: paper::row(views, data_set, job.method.name()).filter(|_| counts == "paper"),
        }));
    }
    rows
}
