//! 837 histograms to 24 angles: many outputs at once.

use anyhow::Result;
use phalanx_rvm::faer::{Mat, MatRef};
use phalanx_rvm::{
    AffineMap, AgarwalTriggs, Bandwidth, BasisSpec, ExpectedGradientOuterProduct, FeatureBlock,
    Kernel, Model, MultiOutputRvm, NystromRidge, OrthogonalLeastSquares, PilotSample, Stop,
    SufficientStatistics,
};

use super::data::Problem;
use super::programs::{Peers, field};
use super::row::{Figure, Row, Target};
use crate::clock::{middle, timed};

/// How many vectors all outputs may share.
const MOST: usize = 150;

/// The penalty of forward selection.
const LAMBDA: f64 = 1e-4;

/// To how many columns Agarwal and Triggs' regression goes down.
const COUNT: usize = 40;

/// A fit, and what it reads in place of the inputs where a distance was learnt first.
struct Made {
    projection: Option<AffineMap>,
    model: Model,
}

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
    let width = width(&problem);
    let rvm = MultiOutputRvm { kernel: Kernel::Gaussian(width), ..MultiOutputRvm::default() };
    let shared =
        measure(&problem, || as_given(&problem, width, |c, s| Ok(rvm.fit_sums(c, s)?.model)))?;
    let few = measure(&problem, || as_given(&problem, width, |c, s| forward(c, s, width)))?;
    let wide = Bandwidth::Relative(3.0);
    let learnt = measure(&problem, || by_distance(&problem, wide, |c, s| forward(c, s, wide)))?;
    let wider = Bandwidth::Relative(4.0);
    let dense = NystromRidge { bandwidth: wider, ..NystromRidge::default() };
    let all =
        measure(&problem, || by_distance(&problem, wider, |c, s| Ok(dense.fit_sums(c, s)?.model)))?;
    let few_vectors = Target::AtMost(MOST as f64);
    let each = "fastrvm × 24";
    let peers = [("fit_total_s", each), ("nvec_mean", each), ("MAE_deg", each)];
    let mut rows = Vec::new();
    for (name, ours, targets) in [
        ("multivariate RVM", &shared, [Target::AtMost(5.0), few_vectors, Target::AtMost(0.80)]),
        ("forward selection", &few, [Target::AtMost(5.0), few_vectors, Target::AtMost(0.80)]),
        (
            "learnt distance, forward selection",
            &learnt,
            [Target::AtMost(5.0), few_vectors, Target::AtMost(0.70)],
        ),
        (
            "learnt distance, all samples",
            &all,
            [Target::AtMost(5.0), Target::Open, Target::AtMost(0.70)],
        ),
    ] {
        let figures = [
            ("time", "s", ours.seconds),
            ("vectors", "", ours.vectors),
            ("mean error", "°", ours.error),
        ];
        for (((figure, unit, ours), target), (key, peer)) in
            figures.into_iter().zip(targets).zip(peers)
        {
            let (work, theirs) = (format!("hand, 837 × 90 → 24: {name}"), read(&fastrvm, key));
            rows.push(Row { work, figure, unit, peer, theirs, ours: Figure::Value(ours), target });
        }
    }
    rows.push(Row {
        work: "hand, 837 × 90 → 24: learnt distance, all samples".to_owned(),
        figure: "mean error",
        unit: "°",
        peer: "kernel ridge",
        theirs: read(&ridge, "MAE_deg"),
        ours: Figure::Value(all.error),
        target: Target::Open,
    });
    let (x, y) = (problem.x.as_ref(), problem.y.as_ref());
    let gaussian = Kernel::Gaussian(Bandwidth::Relative(0.3));
    for (name, kernel) in [("linear", Kernel::Linear), ("Gaussian", gaussian)] {
        let bridges =
            AgarwalTriggs { kernel, stop: Stop::Count(COUNT), ..AgarwalTriggs::default() };
        let fit = || Ok(Made { projection: None, model: bridges.fit(x, y)?.model });
        let ours = measure(&problem, fit)?;
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
/// mean variance of 1, as [`as_given`] does.
fn width(problem: &Problem) -> Bandwidth {
    let x = &problem.x;
    let count = (x.nrows() * x.ncols()) as f64;
    let mean = x.sum() / count;
    let variance = x.squared_norm_l2() / count - mean * mean;
    Bandwidth::Gamma(problem.variance() / (x.nrows() as f64 * variance))
}

/// A fit to inputs that keep their proportions, as the peers'.
fn as_given(
    problem: &Problem,
    width: Bandwidth,
    fit: impl Fn(&BasisSpec, &SufficientStatistics) -> phalanx_rvm::Result<Model>,
) -> phalanx_rvm::Result<Made> {
    Ok(Made { projection: None, model: in_proportion(problem.x.as_ref(), problem, width, fit)? })
}

/// A fit to inputs in which a distance was learnt.
fn by_distance(
    problem: &Problem,
    width: Bandwidth,
    fit: impl Fn(&BasisSpec, &SufficientStatistics) -> phalanx_rvm::Result<Model>,
) -> phalanx_rvm::Result<Made> {
    let (x, y) = (problem.x.as_ref(), problem.y.as_ref());
    let regression =
        NystromRidge { bandwidth: Bandwidth::Relative(1.7), ..NystromRidge::default() };
    let learning = ExpectedGradientOuterProduct {
        regression,
        rounds: 1,
        centres: 400,
        gradients: 400,
        rank: 40,
    };
    let block = FeatureBlock { inputs: x.nrows(), components: 60 };
    let all = vec![(0..y.nrows()).collect()];
    let projection = learning.fit(x, y, &[block], &all)?.projection;
    let inputs: Mat<f64> = projection.apply(x)?;
    let model = in_proportion(inputs.as_ref(), problem, width, fit)?;
    Ok(Made { projection: Some(projection), model })
}

fn in_proportion(
    x: MatRef<'_, f64>,
    problem: &Problem,
    width: Bandwidth,
    fit: impl Fn(&BasisSpec, &SufficientStatistics) -> phalanx_rvm::Result<Model>,
) -> phalanx_rvm::Result<Model> {
    let y = problem.y.as_ref();
    let samples: Vec<usize> = (0..x.ncols()).collect();
    let columns = BasisSpec::in_proportion(&PilotSample { x, y, samples: &samples }, width)?;
    let mut sums = SufficientStatistics::new(&columns);
    sums.add(&columns, x, y)?;
    fit(&columns, &sums)
}

fn forward(
    columns: &BasisSpec,
    sums: &SufficientStatistics,
    width: Bandwidth,
) -> phalanx_rvm::Result<Model> {
    let chosen =
        OrthogonalLeastSquares { count: MOST, lambda: LAMBDA, ..OrthogonalLeastSquares::default() };
    let chosen = OrthogonalLeastSquares { kernel: Kernel::Gaussian(width), ..chosen };
    Ok(chosen.fit_sums(columns, sums)?.model)
}

/// A figure that a script printed in its last line.
fn read(printed: &Result<String>, key: &str) -> Figure {
    match printed {
        Ok(text) => field(text.lines().last().unwrap_or_default(), key).into(),
        Err(error) => Figure::Skipped(format!("{error:#}")),
    }
}

fn measure(problem: &Problem, fit: impl Fn() -> phalanx_rvm::Result<Made>) -> Result<Outcome> {
    let fits = (0..3).map(|_| timed(&fit)).collect::<Result<Vec<_>, _>>()?;
    let seconds = middle(&fits, |(seconds, _)| *seconds);
    let Made { projection, model } = &fits[0].1;
    let test = problem.test_x.as_ref();
    let prediction = match projection {
        Some(projection) => model.predict(projection.apply(test)?.as_ref())?,
        None => model.predict(test)?,
    };
    Ok(Outcome {
        seconds,
        vectors: model.kept_samples().len() as f64,
        error: problem.mean_error(prediction.as_ref()),
    })
}
