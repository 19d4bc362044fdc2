//! Means and standard deviations, for one sample without allocating or for many in parallel.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::data::check;
use crate::error::{Error, Result};
use crate::linalg::axpy;
use crate::model::Model;
use crate::model::parts::{Basis, Factor, Posterior};

/// Centres whose distances grow together.
const LANES: usize = 8;
/// Samples that one task predicts.
const BLOCK: usize = 64;

/// Working memory of single predictions: made once with `default()`, grown at first use.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    /// Standardised features.
    z: Vec<f64>,
    /// Centred basis columns.
    phi: Vec<f64>,
    /// The posterior's columns, and M times them.
    chosen: Vec<f64>,
    spread: Vec<f64>,
    /// A projection's input in single precision, and its output.
    pub(crate) single: Vec<f32>,
    pub(crate) projected: Vec<f64>,
    /// Principal components, and what goes into a network's next layer.
    pub(crate) components: Vec<f64>,
    pub(crate) hidden: Vec<f64>,
}

impl Scratch {
    /// The last prediction's standardised features.
    pub(crate) fn features(&self) -> &[f64] {
        &self.z
    }

    /// The last prediction's centred basis columns.
    pub(crate) fn columns(&self) -> &[f64] {
        &self.phi
    }
}

impl Model {
    /// Mean prediction, m×T, for each column of `x`, K×T. The inputs that the model reads must be
    /// finite. The numbers are those of [`predict_mean_into`](Self::predict_mean_into).
    pub fn predict(&self, x: MatRef<'_, f64>) -> Result<Mat<f64>> {
        let m = self.outputs();
        let mean = self.for_each_sample(x, m, |model, x, scratch, mean| {
            model.predict_mean_into(x, scratch, mean)
        })?;
        Ok(Mat::from_fn(m, x.ncols(), |j, t| mean[t * m + j]))
    }

    /// Mean and standard deviation, both m×T, for each column of `x`, K×T.
    pub fn predict_with_std(&self, x: MatRef<'_, f64>) -> Result<(Mat<f64>, Mat<f64>)> {
        let m = self.outputs();
        let both = self.for_each_sample(x, 2 * m, |model, x, scratch, out| {
            let (mean, std) = out.split_at_mut(m);
            model.predict_into(x, scratch, mean, std)
        })?;
        let part = |offset| Mat::from_fn(m, x.ncols(), |j, t| both[t * 2 * m + offset + j]);
        Ok((part(0), part(m)))
    }

    /// Mean and standard deviation of the m targets of one sample `x` (length K), in the targets'
    /// units. The variance is that of the noise plus that of the function, φᵀΣφ; the deviation is
    /// infinite where the [noise](Self::noise) is not known.
    pub fn predict_into(
        &self,
        x: &[f64],
        scratch: &mut Scratch,
        mean: &mut [f64],
        std: &mut [f64],
    ) -> Result<()> {
        check::length("standard deviations", self.outputs(), std.len())?;
        self.predict_mean_into(x, scratch, mean)?;
        self.deviations(scratch, std);
        Ok(())
    }

    /// Mean of the m targets of one sample `x` (length K).
    pub fn predict_mean_into(
        &self,
        x: &[f64],
        scratch: &mut Scratch,
        mean: &mut [f64],
    ) -> Result<()> {
        check::length("inputs", self.inputs(), x.len())?;
        check::length("means", self.outputs(), mean.len())?;
        self.columns_into(x, scratch)?;
        mean.copy_from_slice(&self.parts.bias);
        for (phi, weights) in scratch.phi.iter().zip(self.parts.weights.chunks_exact(mean.len())) {
            axpy(mean, *phi, weights);
        }
        Ok(())
    }

    /// Runs `predict` on every column of `x`, `width` results each, in blocks of samples.
    fn for_each_sample(
        &self,
        x: MatRef<'_, f64>,
        width: usize,
        predict: impl Fn(&Self, &[f64], &mut Scratch, &mut [f64]) -> Result<()> + Sync,
    ) -> Result<Vec<f64>> {
        check::length("rows of x", self.inputs(), x.nrows())?;
        let mut out = vec![0.0; width * x.ncols()];
        out.par_chunks_mut(width * BLOCK).enumerate().try_for_each(|(block, out)| {
            let mut scratch = Scratch::default();
            let mut sample = vec![0.0; x.nrows()];
            for (t, out) in out.chunks_exact_mut(width).enumerate() {
                let column = block * BLOCK + t;
                sample.iter_mut().zip(x.col(column).iter()).for_each(|(s, v)| *s = *v);
                predict(self, &sample, &mut scratch, out).map_err(|error| at(error, column))?;
            }
            Ok(())
        })?;
        Ok(out)
    }

    /// The centred basis columns of `x`, left in `scratch.phi`.
    fn columns_into(&self, x: &[f64], scratch: &mut Scratch) -> Result<()> {
        let parts = &self.parts;
        let Scratch { z, phi, .. } = scratch;
        z.clear();
        for ((&f, mean), scale) in
            parts.features.iter().zip(&parts.feature_means).zip(&parts.feature_scales)
        {
            if !check::usable(x[f]) {
                return Err(Error::BadValue { what: "x", row: f, column: 0, value: x[f] });
            }
            z.push((x[f] - mean) / scale);
        }
        phi.clear();
        match &parts.basis {
            Basis::Linear => phi.extend_from_slice(z),
            Basis::Gaussian { beta, samples, centres } => {
                phi.resize(samples.len(), 0.0);
                squared_distances(z, centres, phi);
                for value in phi.iter_mut() {
                    *value = (-beta * *value).exp();
                }
            }
        }
        phi.iter_mut().zip(&parts.column_means).for_each(|(value, mean)| *value -= mean);
        Ok(())
    }

    /// Standard deviations at the columns in `scratch.phi`.
    fn deviations(&self, scratch: &mut Scratch, std: &mut [f64]) {
        let noise = self.parts.known_noise();
        match &self.parts.posterior {
            Posterior::Weights(factors) if factors.len() == 1 => {
                let multiple = (1.0 + factors[0].spread(scratch)).sqrt();
                std.iter_mut().zip(noise).for_each(|(std, noise)| *std = noise * multiple);
            }
            Posterior::Weights(factors) => {
                for ((std, noise), factor) in std.iter_mut().zip(noise).zip(factors) {
                    *std = noise * (1.0 + factor.spread(scratch)).sqrt();
                }
            }
            Posterior::Process { factor, lambda } => {
                let spread = self.process_spread(factor, *lambda, scratch);
                let multiple = (1.0 + spread).sqrt();
                std.iter_mut().zip(noise).for_each(|(std, noise)| *std = noise * multiple);
            }
        }
    }

    /// Variance of a centred Gaussian process as a multiple of the noise variance.
    fn process_spread(&self, factor: &Factor, lambda: f64, scratch: &mut Scratch) -> f64 {
        let n = scratch.phi.len() as f64;
        // Columns are centred over the samples; centring over the kernel's other argument too
        // makes k̃(x, xᵢ), and k̃(x, x) from k(x, x) = 1.
        let mean = scratch.phi.iter().sum::<f64>() / n;
        let level = self.parts.column_means.iter().sum::<f64>() / n;
        scratch.phi.iter_mut().for_each(|value| *value -= mean);
        let prior = 1.0 - 2.0 * mean - level;
        (prior - factor.spread(scratch)).max(0.0) / lambda + 1.0 / n
    }
}

impl Factor {
    /// ‖M φ‖² over this factor's columns.
    fn spread(&self, scratch: &mut Scratch) -> f64 {
        let Scratch { phi, chosen, spread, .. } = scratch;
        chosen.clear();
        chosen.extend(self.columns.iter().map(|&c| phi[c]));
        spread.clear();
        spread.resize(chosen.len(), 0.0);
        let mut packed = self.packed.as_slice();
        for (j, &value) in chosen.iter().enumerate() {
            let (column, rest) = packed.split_at(chosen.len() - j);
            axpy(&mut spread[j..], value, column);
            packed = rest;
        }
        spread.iter().map(|v| v * v).sum()
    }
}

/// ‖z − c‖² to each of the centres, which come feature by feature: neighbours in memory, so that
/// this vectorises, and some at a time, so that their sums stay in registers.
fn squared_distances(z: &[f64], centres: &[f64], squared: &mut [f64]) {
    let p = squared.len();
    let Some(last) = p.checked_sub(LANES) else {
        for (z, centres) in z.iter().zip(centres.chunks_exact(p.max(1))) {
            for (squared, centre) in squared.iter_mut().zip(centres) {
                *squared += (z - centre) * (z - centre);
            }
        }
        return;
    };
    // The last group overlaps the one before it, unless the centres divide evenly.
    for start in (0..last).step_by(LANES).chain([last]) {
        let mut sums = [0.0; LANES];
        let groups = centres[start..].chunks(p).filter_map(|row| row.first_chunk::<LANES>());
        for (z, group) in z.iter().zip(groups) {
            for (sum, centre) in sums.iter_mut().zip(group) {
                *sum += (z - centre) * (z - centre);
            }
        }
        squared[start..start + LANES].copy_from_slice(&sums);
    }
}

/// Names the sample in an error about one of its values.
fn at(error: Error, column: usize) -> Error {
    match error {
        Error::BadValue { what, row, value, .. } => Error::BadValue { what, row, column, value },
        other => other,
    }
}
