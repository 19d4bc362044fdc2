//! A multilayer perceptron, trained on CPU threads.

mod adam;
mod layers;
pub(crate) mod missing;
pub(crate) mod network;
pub(crate) mod pca_mlp;
mod samples;
mod scaling;

use faer::{Mat, MatRef};
use phalanx_sampling::shuffle;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::data::check;
use crate::data::scaler::StandardScaler;
use crate::error::{Error, Result};
use crate::mlp::adam::Adam;
use crate::mlp::layers::{DropoutMask, Layers, Pass};
use crate::mlp::missing::{Absence, IncompleteFit, MissingInputs};
use crate::mlp::network::{Mlp, MlpParts};
use crate::mlp::samples::{Samples, check_inputs};
use crate::mlp::scaling::Scaling;
use crate::model::report::{Fit, Report, Trace};
use crate::transform::affine_map::AffineMap;

/// Trains a multilayer perceptron: layers x ↦ s(Wx + b) with s(z) = z/(1 + e⁻ᶻ) (SiLU; Elfwing,
/// Uchibe and Doya 2018), followed by a linear one.
///
/// The loss is the mean absolute error of the standardised targets, minimised by Adam (Kingma and
/// Ba 2015) in shuffled batches with a one-cycle learning rate (Smith and Topin 2019) and dropout
/// (Srivastava et al. 2014). All inputs are divided by one common scale, so bring them to similar
/// scales first, as [`BlockPca`](crate::BlockPca) does.
///
/// One sample in 16, drawn at random, is held out. The standard deviation of each target is its
/// root mean square error on these (with fewer than 128 samples, the target's own deviation). The
/// trace holds their mean absolute error after each epoch, in standardised units. If samples are
/// near-copies of each other, such as neighbouring frames of a video, the held-out errors are too
/// small.
///
/// Use it for tens of thousands of samples whose targets depend on many inputs.
///
/// ```
/// use phalanx_rvm::{MlpTrainer, Regressor, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(2, 2000, |i, t| ((t * (7 + 6 * i)) as f64 * 0.0618).fract() - 0.5);
/// let y = Mat::from_fn(1, 2000, |_, t| x[(0, t)] * x[(1, t)]);
/// let fitter = MlpTrainer { hidden: vec![32, 32], dropout: 0.0, ..MlpTrainer::default() };
/// let network = fitter.fit(x.as_ref(), y.as_ref())?.model;
///
/// let (mut mean, mut std) = ([0.0], [0.0]);
/// network.predict_into(&[0.3, -0.4], &mut Default::default(), &mut mean, &mut std)?;
/// assert!((mean[0] + 0.12).abs() < 0.02 && std[0] < 0.02);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MlpTrainer {
    /// Width of each hidden layer; empty for linear regression.
    pub hidden: Vec<usize>,
    /// Number of passes over the samples.
    pub epochs: usize,
    /// Batch size. Every 128 samples of a batch are one parallel task, with a gradient as large as
    /// the weights.
    pub batch: usize,
    /// Maximum learning rate.
    pub rate: f64,
    /// Dropout probability, in [0, 1).
    pub dropout: f64,
    /// Seed of the initial weights, the held-out samples, the order of samples and dropout.
    pub seed: u64,
}

impl Default for MlpTrainer {
    fn default() -> Self {
        let hidden = vec![512; 3];
        Self { hidden, epochs: 40, batch: 256, rate: 2e-3, dropout: 0.2, seed: 1 }
    }
}

impl MlpTrainer {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit<Mlp>> {
        check::matrix("x", x)?;
        let single = Mat::from_fn(x.nrows(), x.ncols(), |i, t| x[(i, t)] as f32);
        self.fit_single(single.as_ref(), y, &mut |_| ())
    }

    /// Like [`fit`](Self::fit), from inputs in single precision, without a copy. Calls `observe`
    /// with the number of epochs done after each epoch.
    pub fn fit_single(
        &self,
        x: MatRef<'_, f32>,
        y: MatRef<'_, f64>,
        observe: &mut dyn FnMut(usize),
    ) -> Result<Fit<Mlp>> {
        Ok(self.learn(x, y, None, observe)?.0)
    }

    /// Like [`fit_single`](Self::fit_single); then the perceptron learns for `epochs` more from samples of
    /// which inputs are missing, each time others. Both are returned, the first as `fit_single` returns it.
    pub fn fit_incomplete(
        &self,
        x: MatRef<'_, f32>,
        y: MatRef<'_, f64>,
        missing: &MissingInputs,
        epochs: usize,
        observe: &mut dyn FnMut(usize),
    ) -> Result<(Fit<Mlp>, IncompleteFit)> {
        missing.check(x.nrows())?;
        let further = Self { epochs, ..self.clone() };
        further.check()?;
        let (fit, incomplete) = self.learn(x, y, Some((missing, &further)), observe)?;
        let incomplete =
            incomplete.ok_or(Error::Parts { field: "present", problem: "is empty" })?;
        Ok((fit, incomplete))
    }

    fn learn(
        &self,
        x: MatRef<'_, f32>,
        y: MatRef<'_, f64>,
        further: Option<(&MissingInputs, &Self)>,
        observe: &mut dyn FnMut(usize),
    ) -> Result<(Fit<Mlp>, Option<IncompleteFit>)> {
        self.check()?;
        check_inputs(x)?;
        let targets = StandardScaler::fit(y)?;
        check::length("columns (samples) of y", x.ncols(), y.ncols())?;
        let scaling = Scaling::of(x);
        let samples = Samples::new(x, y, &scaling, &targets, self.seed);
        let mut random = Pcg64Mcg::seed_from_u64(self.seed);
        let mut layers = Layers::new(self.widths(x.nrows(), &samples), &mut random);
        let mut errors = Vec::with_capacity(self.epochs);
        if samples.y.nrows() > 0 {
            self.descend(&samples, None, &mut layers, &mut random, &mut |layers, epoch| {
                errors.push(samples.mean_error(layers));
                observe(epoch);
            });
        }
        let network = |layers: &Layers, std: Vec<f64>| -> Result<Mlp> {
            Mlp::from_parts(MlpParts {
                layers: folded(layers, &scaling, &targets)?,
                mean: targets.mean().to_vec(),
                scale: targets.scale().to_vec(),
                std,
            })
        };
        let model = network(&layers, samples.deviations(&layers, &targets, None))?;
        let trace = Trace { converged: true, objective: errors };
        let fit = Fit { model, report: Report::new(vec![trace], None) };
        let Some((missing, further)) = further else { return Ok((fit, None)) };
        let absence = Absence::new(missing, &scaling);
        if samples.y.nrows() > 0 {
            further.descend(&samples, Some(&absence), &mut layers, &mut random, &mut |_, epoch| {
                observe(self.epochs + epoch);
            });
        }
        let of_set = |&set: &u64| samples.deviations(&layers, &targets, Some((&absence, set)));
        let deviations: Vec<Vec<f64>> = missing.present.iter().map(of_set).collect();
        let model = network(&layers, deviations[0].clone())?;
        Ok((fit, Some(IncompleteFit { model, deviations })))
    }

    /// Checks the settings before there are data. The number of samples is not limited.
    pub fn check(&self) -> Result<()> {
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

    /// Number of inputs of each layer, and of outputs of the last.
    fn widths(&self, inputs: usize, samples: &Samples<'_>) -> Vec<usize> {
        let mut widths = vec![inputs];
        widths.extend(&self.hidden);
        widths.push(samples.y.nrows());
        widths
    }

    fn descend(
        &self,
        samples: &Samples<'_>,
        absence: Option<&Absence<'_>>,
        layers: &mut Layers,
        random: &mut Pcg64Mcg,
        after: &mut dyn FnMut(&Layers, usize),
    ) {
        let mut order = samples.learnt_from.clone();
        let batch = self.batch.min(order.len());
        let steps = self.epochs * (order.len() / batch);
        let mut adam = Adam::new(layers.weights().len());
        // The split into passes does not depend on the number of threads.
        let parts = batch.div_ceil(Pass::SAMPLES);
        let mut passes: Vec<Pass> = std::iter::repeat_with(Pass::default).take(parts).collect();
        for epoch in 1..=self.epochs {
            shuffle(&mut order, random);
            for batch in order.chunks_exact(batch) {
                let seeds: Vec<u64> = passes.iter().map(|_| random.next_u64()).collect();
                let parts = passes.par_iter_mut().zip(batch.par_chunks(Pass::SAMPLES));
                parts.zip(seeds).for_each(|((pass, part), seed)| {
                    let mut random = Pcg64Mcg::seed_from_u64(seed);
                    let mut inputs = samples.inputs(part);
                    if let Some(absence) = absence {
                        absence.at_random(&mut inputs, &mut random);
                    }
                    let left_out = DropoutMask { share: self.dropout, random };
                    let left_out = (self.dropout > 0.0).then_some(left_out);
                    pass.forward(layers, inputs, left_out);
                    let count = (batch.len() * samples.y.nrows()) as f32;
                    for (column, &sample) in pass.output_columns().zip(part) {
                        let targets = samples.y.col_as_slice(sample);
                        for (value, target) in column.iter_mut().zip(targets) {
                            *value = (*value - target).signum() / count;
                        }
                    }
                    pass.backward(layers);
                });
                let slopes: Vec<&[f32]> = passes.iter().map(Pass::slopes).collect();
                let rate = self.rate * one_cycle(adam.steps(), steps);
                adam.step(layers.weights_mut(), &slopes, rate);
            }
            after(layers, epoch);
        }
    }
}

/// The learning rate at a step, relative to its maximum (one-cycle schedule).
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

/// The layers, with the scaling of inputs folded into the first and zero rows in the last for
/// constant targets.
fn folded(layers: &Layers, scaling: &Scaling, targets: &StandardScaler) -> Result<Vec<AffineMap>> {
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
            let (mut whole, mut all) = (
                Mat::zeros(targets.scale().len(), matrix.ncols()),
                vec![0.0; targets.scale().len()],
            );
            for (row, &target) in varying.iter().enumerate() {
                all[target] = offset[row];
                for k in 0..matrix.ncols() {
                    whole[(target, k)] = matrix[(row, k)];
                }
            }
            (matrix, offset) = (whole, all);
        }
        projections.push(AffineMap::affine(matrix.as_ref(), &offset)?);
    }
    Ok(projections)
}
