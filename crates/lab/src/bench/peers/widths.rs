//! Friedman's problems, 1000 samples, with widths learnt from the data, beside a dense Gaussian
//! process.

use std::path::Path;

use anyhow::{Result, anyhow};
use phalanx_rvm::ArdRvm;

use super::data::Problem;
use super::programs::{Peers, field};
use super::row::{Figure, Row, Target};
use crate::clock::{middle, timed};

const PROBLEMS: [(&str, &str); 3] = [
    ("fried1_1000", "Friedman 1, 1000, learnt widths"),
    ("fried2_1000", "Friedman 2, 1000, learnt widths"),
    ("fried3_1000", "Friedman 3, 1000, learnt widths"),
];

const REPETITIONS: usize = 3;

/// What is measured of a fit.
#[derive(Clone, Copy)]
struct Outcome {
    rmse: f64,
    kept: f64,
    seconds: f64,
}

pub(crate) fn rows(peers: &Peers) -> Result<Vec<Row>> {
    let folder = match peers.problems() {
        Ok(folder) => folder,
        Err(error) => return Ok(vec![Row::skipped("learnt widths", "Gaussian process", &error)]),
    };
    let (mut printed, mut ours) = (Vec::new(), PROBLEMS.map(|_| Vec::new()));
    for repetition in 1..=REPETITIONS {
        eprintln!("learnt widths, round {repetition} of {REPETITIONS}");
        let data = folder.display().to_string();
        printed.push(peers.script("bench_rvm.py", &[&data, "gpr", "--reps", "1"]));
        for ((name, _), ours) in PROBLEMS.into_iter().zip(&mut ours) {
            ours.push(fit(&folder, name)?);
        }
    }
    let rows = PROBLEMS.into_iter().zip(ours).flat_map(|((name, label), ours)| {
        let theirs: Result<Vec<Outcome>> = printed.iter().map(|p| read(p, name)).collect();
        let row = |figure, unit, factor, of: fn(&Outcome) -> f64| Row {
            work: label.to_owned(),
            figure,
            unit,
            peer: "Gaussian process",
            theirs: theirs.as_ref().map(|all| middle(all, of)).into(),
            ours: Figure::Value(middle(&ours, of)),
            target: Target::AtMostTheirs(factor),
        };
        [
            row("RMSE", "", 1.1, |o| o.rmse),
            row("samples kept", "", 0.15, |o| o.kept),
            row("time", "s", 1.0, |o| o.seconds),
        ]
    });
    Ok(rows.collect())
}

/// What bench_rvm.py printed of a problem.
fn read(printed: &Result<String>, name: &str) -> Result<Outcome> {
    let printed = printed.as_ref().map_err(|error| anyhow!("{error:#}"))?;
    let line = printed.lines().find(|line| line.contains(&format!(",{name},"))).unwrap_or_default();
    Ok(Outcome {
        rmse: field(line, "rmse")?,
        kept: field(line, "nvec")?,
        seconds: field(line, "fit_s")?,
    })
}

fn fit(folder: &Path, name: &str) -> Result<Outcome> {
    let problem = Problem::read(folder, name)?;
    let (x, y) = (problem.x.as_ref(), problem.y.as_ref());
    let (seconds, fit) = timed(|| ArdRvm::default().fit(x, y))?;
    let prediction = fit.model.predict(problem.test_x.as_ref())?;
    Ok(Outcome {
        rmse: problem.rmse(prediction.as_ref()),
        kept: fit.model.kept_samples().len() as f64,
        seconds,
    })
}
