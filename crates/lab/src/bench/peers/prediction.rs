//! One sample of 90 inputs to 24 outputs by 38 Gaussians.

use anyhow::Result;
use phalanx_rvm::faer::Mat;
use phalanx_rvm::{Bandwidth, Kernel, Model, OrthogonalLeastSquares, Scratch};

use super::programs::Peers;
use super::row::{Figure, Row, Target};
use crate::clock::{each, median};

const INPUTS: usize = 90;
const OUTPUTS: usize = 24;
const CENTRES: usize = 38;
const REPETITIONS: usize = 5;
const PREDICTIONS: u32 = 20_000;

pub(crate) fn rows(peers: &Peers) -> Result<Vec<Row>> {
    eprintln!("prediction of one sample");
    let (model, sample) = model()?;
    let (mut theirs, mut ours) = (Vec::new(), Vec::new());
    let counts = [INPUTS, CENTRES, OUTPUTS].map(|count| count.to_string());
    for _ in 0..REPETITIONS {
        let printed = peers.program("predict_one.py", &counts.each_ref().map(String::as_str));
        theirs.push(printed.and_then(|text| Ok(text.trim().parse::<f64>()?)));
        let (mut scratch, mut mean) = (Scratch::default(), [0.0; OUTPUTS]);
        ours.push(each(PREDICTIONS, || model.predict_mean_into(&sample, &mut scratch, &mut mean))?);
    }
    let theirs = theirs.into_iter().collect::<Result<Vec<_>>>();
    Ok(vec![Row {
        work: format!("prediction, one sample, {CENTRES} vectors, {OUTPUTS} outputs"),
        figure: "time",
        unit: "µs",
        peer: "NumPy",
        theirs: theirs.map(|times| median(times).unwrap_or(f64::NAN)).into(),
        ours: median(ours).map_or(Figure::None, |seconds| Figure::Value(1e6 * seconds)),
        target: Target::AtMost(2.0),
    }])
}

/// What it predicts does not matter here, only how much of it there is.
fn model() -> Result<(Model, Vec<f64>)> {
    let wave = |i: usize, t: usize| (0.37 * ((i + 1) * (t + 3)) as f64).sin();
    let x = Mat::from_fn(INPUTS, 4 * CENTRES, wave);
    let y = Mat::from_fn(OUTPUTS, 4 * CENTRES, |j, t| wave(j, t) * wave(j + 1, t));
    let kernel = Kernel::Gaussian(Bandwidth::Relative(1.0));
    let selection =
        OrthogonalLeastSquares { kernel, count: CENTRES, ..OrthogonalLeastSquares::default() };
    let model = selection.fit(x.as_ref(), y.as_ref())?.model;
    Ok((model, x.col_as_slice(0).to_vec()))
}
