//! `cargo xtask eval-table1`: the paper's Table 1 (§ 5.2) on our data.

mod method;
mod paper;
mod print;
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
use method::{Counts, Method};
use paper::PaperRow;
use trial::Outcome;

pub(crate) use method::{Counts as PaperCounts, Method as TableMethod};
pub(crate) use print::{HEADER, legend, lines};

/// The camera of the single-view rows.
const SINGLE_VIEW: &str = "top";
/// Every figure is the mean over this many random even splits.
pub(crate) const SPLITS: u64 = 5;

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

/// One row of the table.
#[derive(Serialize)]
pub(crate) struct Row {
    pub(crate) views: usize,
    pub(crate) data_set: String,
    pub(crate) kernels: &'static str,
    pub(crate) counts: &'static str,
    pub(crate) selected_features: usize,
    pub(crate) selected_samples: usize,
    pub(crate) train_samples: usize,
    pub(crate) test_samples: usize,
    pub(crate) mae_deg: f64,
    pub(crate) std_deg: f64,
    pub(crate) worst_deg: f64,
    pub(crate) worst_dof: &'static str,
    pub(crate) mean_predictor_mae_deg: f64,
    pub(crate) paper: Option<PaperRow>,
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

/// A method at a number of columns, under the names of the rows that it fills.
#[derive(Clone, PartialEq, Eq)]
struct Job {
    method: Method,
    counts: Counts,
    rows: Vec<&'static str>,
}

/// What is fitted on each split: every method at the paper's counts, and the selecting ones at the counts of the most views too, where those differ.
fn jobs(data_set: &Described, views: usize, most_views: usize) -> Vec<Job> {
    let (paper, equal) = (counts(data_set, views), counts(data_set, most_views));
    let mut jobs = Vec::new();
    for method in Method::COUNTED {
        if paper == equal {
            jobs.push(Job { method, counts: paper, rows: vec!["paper", "equal"] });
        } else {
            jobs.push(Job { method, counts: paper, rows: vec!["paper"] });
            jobs.push(Job { method, counts: equal, rows: vec!["equal"] });
        }
    }
    let uncounted = |method| Job { method, counts: paper, rows: vec!["paper"] };
    jobs.extend(Method::UNCOUNTED.map(uncounted));
    jobs
}

/// The paper's counts for a number of views; of samples, as many as there are.
fn counts(data_set: &Described, views: usize) -> Counts {
    Counts::paper(views, &data_set.name).at_most(data_set.poses.len().div_ceil(2))
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
