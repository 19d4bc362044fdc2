//! Friedman's problems, 1000 samples, with widths learnt from the data, beside a dense Gaussian
//! process.

use anyhow::Result;

use super::peers::{Peers, field};
use super::row::{Figure, Row, Target};

const PROBLEMS: [(&str, &str); 3] = [
    ("fried1_1000", "Friedman 1, 1000, learnt width"),
    ("fried2_1000", "Friedman 2, 1000, learnt width"),
    ("fried3_1000", "Friedman 3, 1000, learnt width"),
];

pub(crate) fn rows(peers: &Peers) -> Result<Vec<Row>> {
    let folder = match peers.problems() {
        Ok(folder) => folder.display().to_string(),
        Err(error) => return Ok(vec![Row::skipped("learnt widths", "Gaussian process", &error)]),
    };
    eprintln!("learnt widths");
    let printed = peers.script("bench_rvm.py", &[&folder, "gpr", "--reps", "3"]);
    let theirs = |name: &str, key| {
        let printed = printed.as_ref().map_err(|error| anyhow::anyhow!("{error:#}"))?;
        let line = printed.lines().find(|line| line.contains(&format!(",{name},")));
        field(line.unwrap_or_default(), key)
    };
    let row = |(name, label): (&str, &str), figure, unit, key, target| Row {
        work: label.to_owned(),
        figure,
        unit,
        peer: "Gaussian process",
        theirs: theirs(name, key).into(),
        ours: Figure::Skipped("no learnt widths".to_owned()),
        target,
    };
    Ok(PROBLEMS
        .into_iter()
        .flat_map(|problem| {
            [
                row(problem, "RMSE", "", "rmse", Target::AtMostTheirs(1.1)),
                row(problem, "samples kept", "", "nvec", Target::AtMostTheirs(0.15)),
                row(problem, "time", "s", "fit_s", Target::AtMostTheirs(1.0)),
            ]
        })
        .collect())
}
