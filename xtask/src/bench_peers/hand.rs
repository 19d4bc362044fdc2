//! 837 histograms to 24 angles: many outputs at once.

use anyhow::Result;
use phalanx_rvm::{
    Bridges, Columns, Fit, Kernel, LearntWidths, MultivariateRvm, Pilot, Stop, Sums, Tie, Width,
};

use super::clock::{median, timed};
use super::data::Problem;
use super::peers::{Peers, field};
use super::row::{Figure, Row, Target};

/// How many vectors all outputs may share.
const MOST: usize = 150;

/// The inputs of one camera, which share a width where widths are learnt.
const OF_CAMERA: usize = 30;

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
    let (x, y) = (problem.x.as_ref(), problem.y.as_ref());
    let width = width(&problem);
    let shared = MultivariateRvm {
        kernel: Kernel::Gaussian(width),
        most: Some(MOST),
        ..MultivariateRvm::default()
    };
    let ours = measure(&problem, || fit_in_proportion(&problem, &shared, width))?;
    let learning = LearntWidths {
        rvm: MultivariateRvm { most: Some(MOST), ..MultivariateRvm::default() },
        tie: Tie::Blocks(vec![OF_CAMERA; x.nrows() / OF_CAMERA]),
        ..LearntWidths::default()
    };
    let learnt = measure(&problem, || learning.fit(x, y))?;
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
    let row = |figure, unit, ours, target| Row {
        work: "hand: shared vectors, learnt widths".to_owned(),
        figure,
        unit,
        peer: "",
        theirs: Figure::None,
        ours: Figure::Value(ours),
        target,
    };
    rows.extend([
        row("time", "s", learnt.seconds, Target::Open),
        row("vectors", "", learnt.vectors, Target::AtMost(150.0)),
        row("mean error", "°", learnt.error, Target::AtMost(0.70)),
    ]);
    let gaussian = Kernel::Gaussian(Width::Scatter(0.3));
    for (name, kernel) in [("linear", Kernel::Linear), ("Gaussian", gaussian)] {
        let bridges = Bridges { kernel, stop: Stop::Count(COUNT), ..Bridges::default() };
        let ours = measure(&problem, || bridges.fit(x, y))?;
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

/// What the peers' γ, 1 / (inputs × variance of all numbers), is where inputs are scaled alike to a
/// mean variance of 1, as [`fit_in_proportion`] does.
fn width(problem: &Problem) -> Width {
    let x = &problem.x;
    let count = (x.nrows() * x.ncols()) as f64;
    let mean = x.sum() / count;
    let variance = x.squared_norm_l2() / count - mean * mean;
    Width::Beta(problem.variance() / (x.nrows() as f64 * variance))
}

/// A fit to inputs that keep their proportions, as the peers'.
fn fit_in_proportion(
    problem: &Problem,
    rvm: &MultivariateRvm,
    width: Width,
) -> phalanx_rvm::Result<Fit> {
    let (x, y) = (problem.x.as_ref(), problem.y.as_ref());
    let samples: Vec<usize> = (0..x.ncols()).collect();
    let columns = Columns::in_proportion(&Pilot { x, y, samples: &samples }, width)?;
    let mut sums = Sums::new(&columns);
    sums.add(&columns, x, y)?;
    rvm.fit_sums(&columns, &sums)
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
    Ok(Outcome {
        seconds,
        vectors: model.kept_samples().len() as f64,
        error: problem.mean_error(model.predict(problem.test_x.as_ref())?.as_ref()),
    })
}
