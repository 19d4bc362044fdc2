//! Means and standard deviations, for one sample without allocating or for many in parallel.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::data::check;
use crate::error::{Error, Result};
use crate::linalg::axpy;
use crate::model::Model;
use crate::model::cholesky_factor::CholeskyFactor;
use crate::model::parts::{Basis, Posterior};
use crate::model::regressor::Regressor;
use crate::model::scratch::Scratch;

/// Centres whose distances grow together.
const LANES: usize = 8;
/// Samples that one task predicts.
const BLOCK: usize = 64;

impl Regressor for Model {
    fn inputs(&self) -> usize {
        self.parts.inputs
    }

    fn outputs(&self) -> usize {
        self.parts.outputs
    }

    /// The variance is that of the noise plus that of the function, φᵀΣφ.
    fn predict_into(
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

    /// In parallel.
    fn predict_with_std(&self, x: MatRef<'_, f64>) -> Result<(Mat<f64>, Mat<f64>)> {
        let m = self.outputs();
        let both = self.for_each_sample(x, 2 * m, |model, x, scratch, out| {
            let (mean, std) = out.split_at_mut(m);
            model.predict_into(x, scratch, mean, std)
        })?;
        let part = |offset| Mat::from_fn(m, x.ncols(), |j, t| both[t * 2 * m + offset + j]);
        Ok((part(0), part(m)))
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
                predict(self, &sample, &mut scratch, out).map_err(|error| error.at(column))?;
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
    fn process_spread(&self, factor: &CholeskyFactor, lambda: f64, scratch: &mut Scratch) -> f64 {
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
