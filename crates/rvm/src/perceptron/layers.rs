//! Batches through the layers and back, in single precision, in blocks that do not depend on the
//! number of threads.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Columns of a product that one task computes.
const COLUMNS: usize = 64;

/// The weights of all layers.
pub(super) struct Layers {
    /// How many numbers go into each layer, and out of the last.
    widths: Vec<usize>,
    /// Layer after layer: the matrix, out×in, column after column, and the bias.
    weights: Vec<f32>,
}

/// A batch on its way: what it becomes, and then how the error changes with that.
#[derive(Default)]
pub(super) struct Pass {
    samples: usize,
    /// What goes into each layer, and out of the last.
    values: Vec<Vec<f32>>,
    /// How what goes into each layer but the first changes with what went out of the one before;
    /// 0 where it was left out.
    steepness: Vec<Vec<f32>>,
    slopes: Vec<f32>,
}

impl Layers {
    /// Random weights, uniform within ± 1/√in.
    pub(super) fn new(widths: Vec<usize>, random: &mut Pcg64Mcg) -> Self {
        let mut weights = Vec::new();
        for pair in widths.windows(2) {
            let bound = (pair[0] as f64).sqrt().recip();
            let uniform = || {
                let share = (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
                (bound * (2.0 * share - 1.0)) as f32
            };
            weights.extend(std::iter::repeat_with(uniform).take((pair[0] + 1) * pair[1]));
        }
        Self { widths, weights }
    }

    pub(super) fn count(&self) -> usize {
        self.widths.len() - 1
    }

    pub(super) fn weights(&self) -> &[f32] {
        &self.weights
    }

    pub(super) fn weights_mut(&mut self) -> &mut [f32] {
        &mut self.weights
    }

    /// Matrix and bias of a layer.
    pub(super) fn layer(&self, layer: usize) -> (MatRef<'_, f32>, &[f32]) {
        let (inputs, outputs) = (self.widths[layer], self.widths[layer + 1]);
        let start = self.start(layer);
        let (matrix, bias) =
            self.weights[start..start + (inputs + 1) * outputs].split_at(inputs * outputs);
        (MatRef::from_column_major_slice(matrix, outputs, inputs), bias)
    }

    /// Where a layer's weights begin.
    fn start(&self, layer: usize) -> usize {
        self.widths[..=layer].windows(2).map(|pair| (pair[0] + 1) * pair[1]).sum()
    }
}

impl Pass {
    /// Samples that one pass takes well.
    pub(super) const BLOCK: usize = 256;

    /// Takes samples, one after the other, through all layers. If some of each layer is left out, so
    /// large a share, `bytes` gives that many random ones.
    pub(super) fn forward(
        &mut self,
        layers: &Layers,
        x: Vec<f32>,
        leave_out: Option<f64>,
        bytes: &mut dyn FnMut(usize) -> Vec<u8>,
    ) {
        self.samples = x.len() / layers.widths[0];
        self.values.resize_with(layers.count() + 1, Vec::new);
        self.steepness.resize_with(layers.count() - 1, Vec::new);
        self.values[0] = x;
        for layer in 0..layers.count() {
            let (matrix, bias) = layers.layer(layer);
            let (before, after) = self.values.split_at_mut(layer + 1);
            let input =
                MatRef::from_column_major_slice(&before[layer], matrix.ncols(), self.samples);
            let output = &mut after[0];
            output.resize(matrix.nrows() * self.samples, 0.0);
            product(output, matrix, input);
            for column in output.chunks_exact_mut(matrix.nrows()) {
                column.iter_mut().zip(bias).for_each(|(value, bias)| *value += bias);
            }
            if let Some(steepness) = self.steepness.get_mut(layer) {
                let left_out = leave_out.map(|share| (share, bytes(output.len())));
                bend(output, steepness, left_out.as_ref());
            }
        }
    }

    /// What came out, a column for each sample; how the error changes with it is put in its place.
    pub(super) fn output_columns(&mut self) -> impl Iterator<Item = &mut [f32]> {
        let samples = self.samples;
        let output = self.values.last_mut().expect("went forward");
        let targets = output.len() / samples;
        output.chunks_exact_mut(targets.max(1))
    }

    /// How the error changes with the weights, from how it changes with what came out.
    pub(super) fn backward(&mut self, layers: &Layers) -> &[f32] {
        self.slopes.resize(layers.weights.len(), 0.0);
        for layer in (0..layers.count()).rev() {
            let (matrix, _) = layers.layer(layer);
            let (before, after) = self.values.split_at_mut(layer + 1);
            let (outputs, inputs) = matrix.shape();
            let error = MatRef::from_column_major_slice(&after[0], outputs, self.samples);
            let input = MatRef::from_column_major_slice(&before[layer], inputs, self.samples);
            let start = layers.start(layer);
            let own = &mut self.slopes[start..start + (inputs + 1) * outputs];
            let (of_matrix, of_bias) = own.split_at_mut(inputs * outputs);
            product(of_matrix, error, input.transpose());
            of_bias.fill(0.0);
            for column in after[0].chunks_exact(outputs) {
                of_bias.iter_mut().zip(column).for_each(|(sum, error)| *sum += error);
            }
            if layer > 0 {
                product(&mut before[layer], matrix.transpose(), error);
                let steepness = &self.steepness[layer - 1];
                before[layer].iter_mut().zip(steepness).for_each(|(value, steep)| *value *= steep);
            }
        }
        &self.slopes
    }
}

/// z/(1 + e⁻ᶻ) in place, and its derivative; what is left out is 0, what is kept is larger for it.
fn bend(values: &mut [f32], steepness: &mut Vec<f32>, left_out: Option<&(f64, Vec<u8>)>) {
    steepness.resize(values.len(), 0.0);
    let blocks = values.par_chunks_mut(PER_TASK).zip(steepness.par_chunks_mut(PER_TASK));
    blocks.enumerate().for_each(|(block, (values, steepness))| {
        for (value, steep) in values.iter_mut().zip(&mut *steepness) {
            let share = 1.0 / (1.0 + (-*value).exp());
            *steep = share * (1.0 + *value * (1.0 - share));
            *value *= share;
        }
        if let Some((share, bytes)) = left_out {
            let least = (share * 256.0).round() as u16;
            let grown = 256.0 / f32::from(256 - least.min(255));
            let bytes = &bytes[block * PER_TASK..];
            for ((value, steep), &byte) in values.iter_mut().zip(steepness).zip(bytes) {
                let factor = if u16::from(byte) < least { 0.0 } else { grown };
                *value *= factor;
                *steep *= factor;
            }
        }
    });
}

/// Numbers that one task bends.
const PER_TASK: usize = 1 << 14;

/// A·B, column after column.
fn product(out: &mut [f32], a: MatRef<'_, f32>, b: MatRef<'_, f32>) {
    let rows = a.nrows();
    out.par_chunks_mut(rows * COLUMNS).enumerate().for_each(|(block, out)| {
        let columns = out.len() / rows;
        let b = b.subcols(block * COLUMNS, columns);
        let out = MatMut::from_column_major_slice_mut(out, rows, columns);
        matmul(out, Accum::Replace, a, b, 1.0, Par::Seq);
    });
}

#[cfg(test)]
mod tests {
    use rand_core::SeedableRng;

    use super::*;

    /// The sum of all outputs, each times its place, in plain loops.
    fn slow(layers: &Layers, x: &[f32]) -> f64 {
        let inputs = layers.widths[0];
        let mut sum = 0.0;
        for sample in x.chunks_exact(inputs) {
            let mut values: Vec<f64> = sample.iter().map(|&v| f64::from(v)).collect();
            for layer in 0..layers.count() {
                let (matrix, bias) = layers.layer(layer);
                let row = |i: usize| {
                    let products =
                        values.iter().enumerate().map(|(k, v)| f64::from(matrix[(i, k)]) * v);
                    let z = products.sum::<f64>() + f64::from(bias[i]);
                    if layer + 1 < layers.count() { z / (1.0 + (-z).exp()) } else { z }
                };
                values = (0..matrix.nrows()).map(row).collect();
            }
            sum += values.iter().enumerate().map(|(i, v)| (i + 1) as f64 * v).sum::<f64>();
        }
        sum
    }

    #[test]
    fn slopes_are_those_of_central_differences() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let mut layers = Layers::new(vec![3, 5, 4, 2], &mut random);
        let x: Vec<f32> = (0..21).map(|k| (k as f32 * 0.7).sin()).collect();
        let mut pass = Pass::default();
        pass.forward(&layers, x.clone(), None, &mut |_| Vec::new());
        for column in pass.output_columns() {
            column.copy_from_slice(&[1.0, 2.0]);
        }
        let slopes = pass.backward(&layers).to_vec();
        for (weight, slope) in slopes.into_iter().enumerate() {
            let mut at = |step: f32| {
                let before = layers.weights[weight];
                layers.weights[weight] += step;
                let moved = f64::from(layers.weights[weight] - before);
                let sum = slow(&layers, &x);
                layers.weights[weight] = before;
                (moved, sum)
            };
            let ((up, above), (down, below)) = (at(1e-3), at(-1e-3));
            let expected = (above - below) / (up - down);
            assert!(
                (f64::from(slope) - expected).abs() < 1e-3 * (1.0 + expected.abs()),
                "{weight}"
            );
        }
    }

    #[test]
    fn what_is_left_out_neither_speaks_nor_learns() {
        let mut values: Vec<f32> = (0..1000).map(|k| k as f32 * 0.01 - 5.0).collect();
        let (plain, mut steepness) = (values.clone(), Vec::new());
        let bytes: Vec<u8> = (0..1000).map(|k| (k % 256) as u8).collect();
        bend(&mut values, &mut steepness, Some(&(0.25, bytes)));
        for (k, z) in plain.into_iter().enumerate() {
            let factor = if k % 256 < 64 { 0.0 } else { 4.0 / 3.0 };
            assert!((values[k] - factor * z / (1.0 + (-z).exp())).abs() < 1e-5, "{k}");
            assert_eq!(steepness[k] == 0.0, factor == 0.0, "{k}");
        }
    }
}
