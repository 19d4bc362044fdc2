//! 837 histograms to 24 angles: many outputs at once.

use anyhow::Result;
use phalanx_rvm::{Bridges, Fit, Kernel, MultivariateRvm, Stop, Width};

use super::clock::{median, timed};
use super::data::Problem;
use super::peers::{Peers, field};
use super::row::{Figure, Row, Target};

/// γ = 1/inputs on standardised inputs, as the peers' on their own.
const WIDTH: Width = Width::Scatter(2.0);

/// To how many columns Agarwal and Triggs' regression goes down.
const COUNT: usize = 40;

/// What is measured of our fits.
struct Outcome {
    seconds: f64,
    vectors: f64,
    error: f64,
}

pub(crate) fn rows(peers: &Peers) -> Result<Vec<Row>> {
    let folder = match peers.problems() {
        Ok(folder) => folder,
        Err(error) => return Ok(vec![Row::skipped("hand, 837 × 90 → 24", "fastrvm", &error)]),
    };
    let problem = Problem::read(&folder, "hand")?;
    eprintln!("hand: fastrvm for each output");
    let data = folder.display().to_string();
    let theirs = |peer| peers.script("bench_rvm.py", &[&data, peer, "--hand"]);
    let (fastrvm, ridge) = (theirs("fastrvm"), theirs("krr"));
    eprintln!("hand: ours");
    let kernel = Kernel::Gaussian(WIDTH);
    let shared = MultivariateRvm { kernel, ..MultivariateRvm::default() };
    let ours = measure(&problem, || shared.fit(problem.x.as_ref(), problem.y.as_ref()))?;
    let row = |figure, unit, peer, theirs: Figure, ours, target| Row {
        work: "hand, 837 × 90 → 24: shared vectors".to_owned(),
        figure,
        unit,
        peer,
        theirs,
        ours: Figure::Value(ours),
        target,
    };
    let each = "fastrvm × 24";
    let mut rows = vec![
        row("time", "s", each, read(&fastrvm, "fit_total_s"), ours.seconds, Target::AtMost(5.0)),
        row("vectors", "", each, read(&fastrvm, "nvec_mean"), ours.vectors, Target::AtMost(150.0)),
        row("mean error", "°", each, read(&fastrvm, "MAE_deg"), ours.error, Target::AtMost(0.80)),
        row("mean error", "°", "kernel ridge", read(&ridge, "MAE_deg"), ours.error, Target::Open),
    ];
    for (name, kernel) in [("linear", Kernel::Linear), ("Gaussian", kernel)] {
        let bridges = Bridges { kernel, stop: Stop::Count(COUNT), ..Bridges::default() };
        let ours = measure(&problem, || bridges.fit(problem.x.as_ref(), problem.y.as_ref()))?;
        let row = |figure, unit, ours, target| Row {
            work: format!("Agarwal–Triggs on it to {COUNT}, {name}"),
            figure,
            unit,
            peer: "",
            theirs: Figure::None,
            ours: Figure::Value(ours),
            target,
        };
        rows.push(row("time", "s", ours.seconds, Target::AtMost(1.0)));
        rows.push(row("mean error", "°", ours.error, Target::Open));
    }
    Ok(rows)
}

/// A figure that a script printed in its last line.
fn read(printed: &Result<String>, key: &str) -> Figure {
    match printed {
        Ok(text) => field(text.lines().last().unwrap_or_default(), key).into(),
        Err(error) => Figure::Skipped(format!("{error:#}")),
    }
}

fn measure(problem: &Problem, fit: impl Fn() -> phalanx_rvm::Result<Fit>) -> Result<Outcome> {
    let fits = (0..3).map(|_| timed(&fit)).collect::<Result<Vec<_>, _>>()?;
    let seconds = median(fits.iter().map(|(seconds, _)| *seconds)).unwrap_or(f64::NAN);
    let model = &fits[0].1.model;
    let columns = model
        .kept_samples()
        .len()
        .max(model.selected_features().len() * usize::from(model.kept_samples().is_empty()));
    Ok(Outcome {
        seconds,
        vectors: columns as f64,
        error: problem.mean_error(model.predict(problem.test_x.as_ref())?.as_ref()),
    })
}
