//! Relevance vector machines at a given width: sinc and Friedman's problems, beside fastrvm.

use std::path::Path;

use anyhow::{Context, Result};
use phalanx_rvm::{Bandwidth, Kernel, RelevanceVectorMachine};

use super::data::Problem;
use super::programs::{Conversation, Peers};
use super::row::{Figure, Row, Target};
use crate::clock::{middle, timed};

/// Names of the files, names to print, and γ; that of Friedman's is one over the inputs.
const PROBLEMS: [(&str, &str, Option<f64>); 13] = [
    ("sinc_100", "sinc, 100", Some(1.0 / 9.0)),
    ("sinc_200", "sinc, 200", Some(1.0 / 9.0)),
    ("sinc_500", "sinc, 500", Some(1.0 / 9.0)),
    ("sinc_1000", "sinc, 1000", Some(1.0 / 9.0)),
    ("fried1_240", "Friedman 1, 240", None),
    ("fried1_500", "Friedman 1, 500", None),
    ("fried1_1000", "Friedman 1, 1000", None),
    ("fried2_240", "Friedman 2, 240", None),
    ("fried2_500", "Friedman 2, 500", None),
    ("fried2_1000", "Friedman 2, 1000", None),
    ("fried3_240", "Friedman 3, 240", None),
    ("fried3_500", "Friedman 3, 500", None),
    ("fried3_1000", "Friedman 3, 1000", None),
];

/// The one whose time is aimed at.
const TIMED: &str = "fried1_1000";

/// Least and most repetitions, and after how many seconds of fitting there are enough.
const REPETITIONS: std::ops::RangeInclusive<usize> = 3..=15;
const ENOUGH: f64 = 0.5;

/// What is measured of a fit.
#[derive(Clone, Copy)]
struct Outcome {
    seconds: f64,
    vectors: f64,
    rmse: f64,
    /// Nats, of the standardised targets with a flat bias integrated out.
    evidence: f64,
}

pub(crate) fn rows(peers: &Peers) -> Result<Vec<Row>> {
    let folder = match peers.problems() {
        Ok(folder) => folder,
        Err(error) => return Ok(vec![Row::skipped("sinc and Friedman 1–3", "fastrvm", &error)]),
    };
    let mut fastrvm = peers.conversation("fastrvm_fits.py", &folder);
    let mut rows = Vec::new();
    for (name, label, gamma) in PROBLEMS {
        eprintln!("{label}");
        rows.extend(compare(&folder, name, label, gamma, &mut fastrvm)?);
    }
    Ok(rows)
}

fn compare(
    folder: &Path,
    name: &str,
    label: &str,
    gamma: Option<f64>,
    fastrvm: &mut Result<Conversation>,
) -> Result<[Row; 4]> {
    let problem = Problem::read(folder, name)?;
    let gamma = gamma.unwrap_or(1.0 / problem.x.nrows() as f64);
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    while ours.len() < *REPETITIONS.start()
        || ours.len() < *REPETITIONS.end()
            && ours.iter().map(|o: &Outcome| o.seconds).sum::<f64>() < ENOUGH
    {
        theirs.push(fit_theirs(name, gamma, fastrvm));
        ours.push(fit_ours(&problem, gamma)?);
    }
    let theirs: Result<Vec<Outcome>> = theirs.into_iter().collect();
    let row = |figure, unit, target, of: fn(&Outcome) -> f64| Row {
        work: label.to_owned(),
        figure,
        unit,
        peer: "fastrvm",
        theirs: theirs.as_ref().map(|all| middle(all, of)).into(),
        ours: Figure::Value(middle(&ours, of)),
        target,
    };
    let time = if name == TIMED { Target::AtMostTheirs(1.0 / 3.0) } else { Target::Open };
    Ok([
        row("log evidence", "", Target::NotLowerBy(1e-3), |o| o.evidence),
        row("RMSE", "", Target::AtMostTheirs(1.05), |o| o.rmse),
        row("vectors", "", Target::AtMostTheirs(1.1), |o| o.vectors),
        row("time", "s", time, |o| o.seconds),
    ])
}

fn fit_theirs(name: &str, gamma: f64, fastrvm: &mut Result<Conversation>) -> Result<Outcome> {
    let fastrvm = fastrvm.as_mut().map_err(|error| anyhow::anyhow!("{error:#}"))?;
    let [seconds, vectors, rmse, evidence] = fastrvm.ask(&format!("{name} {gamma}"))?;
    Ok(Outcome { seconds, vectors, rmse, evidence })
}

fn fit_ours(problem: &Problem, gamma: f64) -> Result<Outcome> {
    // Ours sees standardised inputs, among which γ is as many times larger as distances are.
    let kernel = Kernel::Gaussian(Bandwidth::Gamma(gamma * problem.variance()));
    let tipping = RelevanceVectorMachine { kernel, ..RelevanceVectorMachine::default() };
    let (seconds, fit) = timed(|| tipping.fit(problem.x.as_ref(), problem.y.as_ref()))?;
    let prediction = fit.model.predict(problem.test_x.as_ref())?;
    let trace = fit.report.traces.first().context("a fit without a trace")?;
    Ok(Outcome {
        seconds,
        vectors: fit.model.kept_samples().len() as f64,
        rmse: problem.rmse(prediction.as_ref()),
        evidence: trace.objective.last().copied().unwrap_or(f64::NAN),
    })
}
