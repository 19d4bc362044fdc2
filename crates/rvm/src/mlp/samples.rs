//! Training samples of a perceptron, and its errors on held-out ones.

use faer::{Mat, MatRef};
use phalanx_sampling::random_subset;
use rayon::prelude::*;

use crate::data::scaler::StandardScaler;
use crate::error::{Error, Result};
use crate::mlp::layers::{Layers, Pass};
use crate::mlp::missing::Absence;
use crate::mlp::scaling::Scaling;

/// One sample in this many is held out.
const HELD_OUT: usize = 16;
/// Fewer held-out samples give no useful deviation: its relative error is 1/√(2n).
const LEAST_HELD_OUT: usize = 8;

/// The samples.
pub(super) struct Samples<'a> {
    /// K×I, borrowed: a copy may not fit into memory.
    x: MatRef<'a, f32>,
    scaling: &'a Scaling,
    /// Scaled targets that vary, m×I.
    pub(super) y: Mat<f32>,
    pub(super) learnt_from: Vec<usize>,
    held_out: Vec<usize>,
}

/// Refuses empty inputs, and values that are not finite.
pub(super) fn check_inputs(x: MatRef<'_, f32>) -> Result<()> {
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

impl<'a> Samples<'a> {
    pub(super) fn new(
        x: MatRef<'a, f32>,
        y: MatRef<'_, f64>,
        scaling: &'a Scaling,
        targets: &StandardScaler,
        seed: u64,
    ) -> Self {
        let varying = targets.varying();
        let target = |j: usize, i: usize| targets.scaled(varying[j], y[(varying[j], i)]) as f32;
        let held_out = random_subset(x.ncols(), x.ncols() / HELD_OUT, seed);
        let learnt_from = (0..x.ncols()).filter(|i| held_out.binary_search(i).is_err()).collect();
        Self {
            x,
            scaling,
            y: Mat::from_fn(varying.len(), x.ncols(), target),
            learnt_from,
            held_out,
        }
    }

    /// The inputs of some samples, scaled, one after the other.
    pub(super) fn inputs(&self, samples: &[usize]) -> Vec<f32> {
        let Scaling { mean, factor } = self.scaling;
        let scaled = |(&value, mean): (&f32, &f64)| ((f64::from(value) - mean) * factor) as f32;
        samples.iter().flat_map(|&sample| self.x.col(sample).iter().zip(mean).map(scaled)).collect()
    }

    /// Samples that errors are measured on: the held-out ones or, if there are none, all.
    fn judges(&self) -> &[usize] {
        if self.held_out.is_empty() { &self.learnt_from } else { &self.held_out }
    }

    /// Prediction errors on these samples, one after the other, where what `absence` says is missing.
    fn differences(&self, layers: &Layers, absence: Option<(&Absence<'_>, u64)>) -> Vec<f32> {
        let differences = |pass: &mut Pass, some: &[usize]| {
            let mut inputs = self.inputs(some);
            if let Some((absence, present)) = absence {
                absence.leave(present, &mut inputs);
            }
            pass.forward(layers, inputs, None);
            let pairs = pass.output_columns().zip(some).flat_map(|(column, &sample)| {
                let pairs = column.iter().zip(self.y.col_as_slice(sample));
                pairs.map(|(value, target)| value - target)
            });
            pairs.collect::<Vec<f32>>()
        };
        let parts = self.judges().par_chunks(Pass::SAMPLES).map_init(Pass::default, differences);
        parts.collect::<Vec<_>>().concat()
    }

    pub(super) fn mean_error(&self, layers: &Layers) -> f64 {
        let differences = self.differences(layers, None);
        differences.iter().map(|d| f64::from(d.abs())).sum::<f64>() / differences.len() as f64
    }

    /// The root mean square error of each target, in its own unit, or the target's own deviation
    /// where too few samples are held out; 0 of those that do not vary.
    pub(super) fn deviations(
        &self,
        layers: &Layers,
        targets: &StandardScaler,
        absence: Option<(&Absence<'_>, u64)>,
    ) -> Vec<f64> {
        let mut deviations = targets.scale().to_vec();
        let varying = targets.varying();
        if varying.is_empty() || self.held_out.len() < LEAST_HELD_OUT {
            return deviations;
        }
        let differences = self.differences(layers, absence);
        for (j, &target) in varying.iter().enumerate() {
            let own = differences.iter().skip(j).step_by(varying.len());
            let squares: f64 = own.map(|d| f64::from(*d).powi(2)).sum();
            let mean = squares / self.judges().len() as f64;
            deviations[target] = mean.sqrt() * targets.scale()[target];
        }
        deviations
    }
}
