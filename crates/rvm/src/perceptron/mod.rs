//! A small perceptron, fitted in minutes without a graphics card.

mod adam;
mod layers;
mod network;
mod on_components;

use faer::{Mat, MatRef};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

pub use network::Network;
pub use on_components::NetworkOnComponents;

use crate::perceptron::adam::Adam;
use crate::perceptron::layers::{Layers, Pass};
use crate::{Error, Projection, ProjectionParts, Report, Result, Standardiser, Trace, check};

/// Of so many samples one is held out: it tells how far predictions are off.
const HELD_OUT: usize = 16;

/// A multilayer perceptron: layers of x ↦ s(Wx + b), s(z) = z/(1 + e⁻ᶻ) (Elfwing, Uchibe and Doya
/// 2018), and a linear one after them.
///
/// Fitted to the mean absolute error of the standardised targets by Adam (Kingma and Ba 2015) in
/// shuffled batches, at a rate that rises over the first third of the steps and falls to nothing
/// over the others (Smith and Topin 2019), with dropout (Srivastava et al. 2014). Inputs keep their
/// proportions: put them on one scale first, as [`Components`](crate::Components) does.
///
/// Every 16th sample is not learnt from; the standard deviations are the root mean square errors of
/// these, one for each target, and the trace holds their mean absolute error, in standardised units,
/// after each epoch.
///
/// For targets that depend on many inputs at once, and samples that go into the tens of thousands.
///
/// ```
/// use phalanx_rvm::{Perceptron, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(2, 2000, |i, t| ((t * (7 + 6 * i)) as f32 * 0.0618).fract() - 0.5);
/// let y = Mat::from_fn(1, 2000, |_, t| f64::from(x[(0, t)] * x[(1, t)]));
/// let fitter = Perceptron { hidden: vec![32, 32], dropout: 0.0, ..Perceptron::default() };
/// let network = fitter.fit(x.as_ref(), y.as_ref())?.network;
///
/// let (mut mean, mut std) = ([0.0], [0.0]);
/// network.predict_into(&[0.3, -0.4], &mut Default::default(), &mut mean, &mut std)?;
/// assert!((mean[0] + 0.12).abs() < 0.02 && std[0] < 0.02);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Perceptron {
    /// How wide each layer is but the last; none for linear regression.
    pub hidden: Vec<usize>,
    /// How often each sample is looked at.
    pub epochs: usize,
    /// Samples of a step, at most.
    pub batch: usize,
    /// The highest rate.
    pub rate: f64,
    /// The share of each layer that is left out at each step, from 0 to below 1.
    pub dropout: f64,
    /// Of the first weights, the order of samples and what is left out.
    pub seed: u64,
}

/// A fitted network and how the fitting went.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedNetwork {
    /// The network.
    pub network: Network,
    /// How the fitting went.
    pub report: Report,
}

/// The samples, scaled.
struct Samples {
    /// K×I.
    x: Mat<f32>,
    /// Those targets that vary, m×I.
    y: Mat<f32>,
    learnt_from: Vec<usize>,
    held_out: Vec<usize>,
}

impl Default for Perceptron {
    fn default() -> Self {
        let hidden = vec![512; 3];
        Self { hidden, epochs: 40, batch: 256, rate: 2e-3, dropout: 0.2, seed: 1 }
    }
}

impl Perceptron {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f32>, y: MatRef<'_, f64>) -> Result<FittedNetwork> {
        self.fit_observed(x, y, &mut |_| ())
    }

    /// Fits X (K×I) to Y (m×I); `observe` is told the number of epochs done after each.
    pub fn fit_observed(
        &self,
        x: MatRef<'_, f32>,
        y: MatRef<'_, f64>,
        observe: &mut dyn FnMut(usize),
    ) -> Result<FittedNetwork> {
        self.check()?;
        inputs(x)?;
        let targets = Standardiser::fit(y)?;
        check::length("columns (samples) of y", x.ncols(), y.ncols())?;
        let scaling = Scaling::of(x);
        let samples = Samples::new(x, y, &scaling, &targets);
        let mut random = Pcg64Mcg::seed_from_u64(self.seed);
        let mut layers = Layers::new(self.widths(&samples), &mut random);
        let mut errors = Vec::with_capacity(self.epochs);
        if samples.y.nrows() > 0 {
            self.descend(&samples, &mut layers, &mut random, &mut |layers, epoch| {
                errors.push(samples.mean_error(layers));
                observe(epoch);
            });
        }
        let network = Network::from_parts(
            folded(&layers, &scaling, &targets)?,
            samples.deviations(&layers, &targets),
        )?;
        let trace = Trace { converged: true, objective: errors };
        Ok(FittedNetwork { network, report: Report::new(vec![trace], None) })
    }

    fn check(&self) -> Result<()> {
        check::positive("rate", self.rate)?;
        for (name, count) in [("epochs", self.epochs), ("batch", self.batch)] {
            if count == 0 {
                return Err(Error::Parameter { name, value: 0.0, requirement: "at least 1" });
            }
        }
        if self.hidden.contains(&0) {
            let requirement = "at least 1 wide everywhere";
            return Err(Error::Parameter { name: "hidden", value: 0.0, requirement });
        }
        if !(0.0..1.0).contains(&self.dropout) {
            let requirement = "from 0 to below 1";
            return Err(Error::Parameter { name: "dropout", value: self.dropout, requirement });
        }
        Ok(())
    }

    /// How many numbers go into each layer, and out of the last.
    fn widths(&self, samples: &Samples) -> Vec<usize> {
        let mut widths = vec![samples.x.nrows()];
        widths.extend(&self.hidden);
        widths.push(samples.y.nrows());
        widths
    }

    fn descend(
        &self,
        samples: &Samples,
        layers: &mut Layers,
        random: &mut Pcg64Mcg,
        after: &mut dyn FnMut(&Layers, usize),
    ) {
        let mut order = samples.learnt_from.clone();
        let batch = self.batch.min(order.len());
        let steps = self.epochs * (order.len() / batch);
        let mut adam = Adam::new(layers.weights().len());
        let mut pass = Pass::default();
        for epoch in 1..=self.epochs {
            shuffle(&mut order, random);
            for batch in order.chunks_exact(batch) {
                let mut bytes = |count| {
                    let mut bytes = vec![0; count];
                    random.fill_bytes(&mut bytes);
                    bytes
                };
                let leave_out = (self.dropout > 0.0).then_some(self.dropout);
                pass.forward(layers, gathered(samples.x.as_ref(), batch), leave_out, &mut bytes);
                let count = (batch.len() * samples.y.nrows()) as f32;
                for (column, &sample) in pass.output_columns().zip(batch) {
                    for (value, target) in column.iter_mut().zip(samples.y.col_as_slice(sample)) {
                        *value = (*value - target).signum() / count;
                    }
                }
                let slopes = pass.backward(layers);
                adam.step(layers.weights_mut(), slopes, self.rate * one_cycle(adam.steps(), steps));
            }
            after(layers, epoch);
        }
    }
}

/// The share of the highest rate at a step of so many.
fn one_cycle(step: usize, steps: usize) -> f64 {
    const RISE: f64 = 0.3;
    const FIRST: f64 = 0.04;
    let at = step as f64 / steps as f64;
    let between = |from: f64, to: f64, share: f64| {
        to + (from - to) * 0.5 * (1.0 + (std::f64::consts::PI * share).cos())
    };
    if at < RISE {
        between(FIRST, 1.0, at / RISE)
    } else {
        between(1.0, 0.0, (at - RISE) / (1.0 - RISE))
    }
}

/// A random order (Fisher and Yates).
fn shuffle(order: &mut [usize], random: &mut Pcg64Mcg) {
    for last in (1..order.len()).rev() {
        // The bias of so short a range in 64 bits is nothing.
        let other = (u128::from(random.next_u64()) * (last as u128 + 1)) >> 64;
        order.swap(last, other as usize);
    }
}

fn inputs(x: MatRef<'_, f32>) -> Result<()> {
    let (rows, columns) = x.shape();
    if rows == 0 || columns == 0 {
        return Err(Error::Empty { what: "x", rows, columns });
    }
    for (column, values) in x.col_iter().enumerate() {
        if let Some(row) = values.iter().position(|value| !value.is_finite()) {
            let value = f64::from(x[(row, column)]);
            return Err(Error::BadValue { what: "x", row, column, value });
        }
    }
    Ok(())
}

/// How inputs are brought to means of zero and a mean variance of 1.
struct Scaling {
    mean: Vec<f64>,
    /// What they are multiplied by; 0 where nothing varies.
    factor: f64,
}

impl Scaling {
    fn of(x: MatRef<'_, f32>) -> Self {
        let count = x.ncols() as f64;
        let mut mean = vec![0.0; x.nrows()];
        for column in x.col_iter() {
            mean.iter_mut().zip(column.iter()).for_each(|(sum, &v)| *sum += f64::from(v) / count);
        }
        let offset = |column: faer::ColRef<'_, f32>| -> f64 {
            column.iter().zip(&mean).map(|(&v, mean)| (f64::from(v) - mean).powi(2)).sum()
        };
        let squares: f64 = x.col_iter().map(offset).sum();
        let variance = squares / (count * x.nrows() as f64);
        let factor = if variance > 0.0 { variance.sqrt().recip() } else { 0.0 };
        Self { mean, factor }
    }
}

impl Samples {
    fn new(
        x: MatRef<'_, f32>,
        y: MatRef<'_, f64>,
        scaling: &Scaling,
        targets: &Standardiser,
    ) -> Self {
        let varying = targets.varying();
        let scaled =
            |k: usize, i: usize| ((f64::from(x[(k, i)]) - scaling.mean[k]) * scaling.factor) as f32;
        let target = |j: usize, i: usize| targets.scaled(varying[j], y[(varying[j], i)]) as f32;
        let is_held_out = |i: &usize| i % HELD_OUT == HELD_OUT - 1;
        let (held_out, learnt_from) = (0..x.ncols()).partition(is_held_out);
        Self {
            x: Mat::from_fn(x.nrows(), x.ncols(), scaled),
            y: Mat::from_fn(varying.len(), x.ncols(), target),
            learnt_from,
            held_out,
        }
    }

    /// What tells how far predictions are off: the samples held out or, of a handful, all.
    fn judges(&self) -> &[usize] {
        if self.held_out.is_empty() { &self.learnt_from } else { &self.held_out }
    }

    /// The differences from the targets of all judges, one after the other.
    fn differences(&self, layers: &Layers) -> Vec<f32> {
        let mut pass = Pass::default();
        let mut differences = Vec::with_capacity(self.judges().len() * self.y.nrows());
        for some in self.judges().chunks(Pass::BLOCK) {
            pass.forward(layers, gathered(self.x.as_ref(), some), None, &mut |_| Vec::new());
            for (column, &sample) in pass.output_columns().zip(some) {
                let pairs = column.iter().zip(self.y.col_as_slice(sample));
                differences.extend(pairs.map(|(value, target)| value - target));
            }
        }
        differences
    }

    fn mean_error(&self, layers: &Layers) -> f64 {
        let differences = self.differences(layers);
        differences.iter().map(|d| f64::from(d.abs())).sum::<f64>() / differences.len() as f64
    }

    /// The root mean square error of each target, in its own unit; 0 of those that do not vary.
    fn deviations(&self, layers: &Layers, targets: &Standardiser) -> Vec<f64> {
        let mut deviations = vec![0.0; targets.scale().len()];
        let varying = targets.varying();
        if varying.is_empty() {
            return deviations;
        }
        let differences = self.differences(layers);
        for (j, &target) in varying.iter().enumerate() {
            let own = differences.iter().skip(j).step_by(varying.len());
            let squares: f64 = own.map(|d| f64::from(*d).powi(2)).sum();
            let mean = squares / self.judges().len() as f64;
            deviations[target] = mean.sqrt() * targets.scale()[target];
        }
        deviations
    }
}

/// Some columns, one after the other.
fn gathered(x: MatRef<'_, f32>, samples: &[usize]) -> Vec<f32> {
    samples.iter().flat_map(|&sample| x.col(sample).iter().copied()).collect()
}

/// The layers with the scaling of inputs in the first and of targets in the last.
fn folded(layers: &Layers, scaling: &Scaling, targets: &Standardiser) -> Result<Vec<Projection>> {
    let last = layers.count() - 1;
    let varying = targets.varying();
    let mut projections = Vec::with_capacity(layers.count());
    for layer in 0..layers.count() {
        let (weights, bias) = layers.layer(layer);
        let mut matrix =
            Mat::from_fn(weights.nrows(), weights.ncols(), |i, k| f64::from(weights[(i, k)]));
        let mut offset: Vec<f64> = bias.iter().map(|&b| f64::from(b)).collect();
        if layer == 0 {
            matrix *= faer::Scale(scaling.factor);
            for (k, mean) in scaling.mean.iter().enumerate() {
                let column = matrix.col(k);
                offset
                    .iter_mut()
                    .zip(column.iter())
                    .for_each(|(sum, weight)| *sum -= weight * mean);
            }
        }
        if layer == last {
            let mut whole = Mat::zeros(targets.scale().len(), matrix.ncols());
            let mut constants = targets.mean().to_vec();
            for (row, &target) in varying.iter().enumerate() {
                let scale = targets.scale()[target];
                constants[target] += scale * offset[row];
                for k in 0..matrix.ncols() {
                    whole[(target, k)] = scale * matrix[(row, k)];
                }
            }
            (matrix, offset) = (whole, constants);
        }
        projections.push(Projection::from_parts(ProjectionParts {
            inputs: matrix.ncols(),
            matrix: matrix
                .col_iter()
                .flat_map(|c| c.iter().map(|&v| v as f32).collect::<Vec<_>>())
                .collect(),
            offset: offset.into_iter().map(|v| v as f32).collect(),
        })?);
    }
    Ok(projections)
}
