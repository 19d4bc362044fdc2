//! Forward and backward passes through the layers, in single precision, on one thread.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;

/// The weights of all layers.
pub(super) struct Layers {
    /// Number of inputs of each layer, and of outputs of the last.
    widths: Vec<usize>,
    /// Layer after layer: the matrix, out×in, column after column, and the bias.
    weights: Vec<f32>,
}

/// Dropout: sets each value to zero with this probability.
pub(super) struct DropoutMask {
    pub(super) share: f64,
    pub(super) random: Pcg64Mcg,
}

/// The activations of some samples; after the backward pass, the gradients of the error by them.
#[derive(Default)]
pub(super) struct Pass {
    samples: usize,
    /// Inputs of each layer, and outputs of the last.
    values: Vec<Vec<f32>>,
    /// Derivatives of the activation function at each hidden layer; 0 where dropped out.
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
    /// Samples of one pass. Another number would round sums differently.
    pub(super) const SAMPLES: usize = 128;

    /// Runs samples, stored one after the other, through all layers.
    pub(super) fn forward(
        &mut self,
        layers: &Layers,
        x: Vec<f32>,
        mut left_out: Option<DropoutMask>,
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
                bend(output, steepness);
                if let Some(left_out) = &mut left_out {
                    left_out.leave_out(output, steepness);
                }
            }
        }
    }

    /// The outputs, one column for each sample, to be replaced by the gradient of the error.
    pub(super) fn output_columns(&mut self) -> impl Iterator<Item = &mut [f32]> {
        let samples = self.samples;
        let output = self.values.last_mut().expect("went forward");
        let targets = output.len() / samples;
        output.chunks_exact_mut(targets.max(1))
    }

    /// The gradient of the error by the weights, after [`backward`](Self::backward).
    pub(super) fn slopes(&self) -> &[f32] {
        &self.slopes
    }

    /// Computes the gradient of the error by the weights from that by the outputs.
    pub(super) fn backward(&mut self, layers: &Layers) {
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
    }
}

impl DropoutMask {
    /// Sets some values and their derivatives to 0 and scales the others up.
    fn leave_out(&mut self, values: &mut [f32], steepness: &mut [f32]) {
        let mut bytes = vec![0; values.len()];
        self.random.fill_bytes(&mut bytes);
        let least = (self.share * 256.0).round() as u16;
        let grown = 256.0 / f32::from(256 - least.min(255));
        for ((value, steep), byte) in values.iter_mut().zip(steepness).zip(bytes) {
            let factor = if u16::from(byte) < least { 0.0 } else { grown };
            *value *= factor;
            *steep *= factor;
        }
    }
}

/// z/(1 + e⁻ᶻ) in place, and its derivative.
fn bend(values: &mut [f32], steepness: &mut Vec<f32>) {
    steepness.resize(values.len(), 0.0);
    for (value, steep) in values.iter_mut().zip(steepness) {
        let share = 1.0 / (1.0 + exp(-*value));
        *steep = share * (1.0 + *value * (1.0 - share));
        *value *= share;
    }
}

/// eˣ to within two units in the last place; x is clamped to −87 … 88, where the result is a normal
/// number. Unlike the standard library's, it can be vectorised.
fn exp(x: f32) -> f32 {
    use std::f32::consts::LOG2_E;
    /// Adding it puts the nearest integer into the lowest bits.
    const SHIFT: f32 = 12_582_912.0;
    /// ln 2 in two parts, of which the first has so few bits that its multiples are exact.
    const LN_2: [f32; 2] = [355.0 / 512.0, -2.121_944_4e-4];
    let x = x.clamp(-87.0, 88.0);
    let shifted = x * LOG2_E + SHIFT;
    let whole = shifted - SHIFT;
    let rest = (x - whole * LN_2[0]) - whole * LN_2[1];
    let series = [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0];
    let of_rest = series.into_iter().fold(0.0, |sum, term| sum * rest + term);
    of_rest * f32::from_bits((shifted.to_bits() << 23).wrapping_add(1.0_f32.to_bits()))
}

/// A·B, column after column.
fn product(out: &mut [f32], a: MatRef<'_, f32>, b: MatRef<'_, f32>) {
    let out = MatMut::from_column_major_slice_mut(out, a.nrows(), b.ncols());
    matmul(out, Accum::Replace, a, b, 1.0, Par::Seq);
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
        pass.forward(&layers, x.clone(), None);
        for column in pass.output_columns() {
            column.copy_from_slice(&[1.0, 2.0]);
        }
        pass.backward(&layers);
        for (weight, &slope) in pass.slopes().iter().enumerate() {
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
        let mut values: Vec<f32> = (0..100_000).map(|k| k as f32 * 1e-4 - 5.0).collect();
        let mut steepness = Vec::new();
        bend(&mut values, &mut steepness);
        let (plain, plain_steepness) = (values.clone(), steepness.clone());
        let random = Pcg64Mcg::seed_from_u64(1);
        DropoutMask { share: 0.25, random }.leave_out(&mut values, &mut steepness);
        let mut left_out = 0;
        for k in 0..values.len() {
            let factor = if steepness[k] == 0.0 { 0.0 } else { 4.0 / 3.0 };
            left_out += usize::from(steepness[k] == 0.0);
            assert!((values[k] - factor * plain[k]).abs() < 1e-5, "{k}");
            assert!((steepness[k] - factor * plain_steepness[k]).abs() < 1e-5, "{k}");
        }
        assert!((left_out as f64 / values.len() as f64 - 0.25).abs() < 0.01, "{left_out}");
    }

    #[test]
    fn the_exponential_is_the_systems() {
        for k in -86_999..88_000 {
            let x = k as f32 * 1e-3;
            let off = (f64::from(exp(x)) / f64::from(x).exp() - 1.0).abs();
            assert!(off < 3e-7, "e^{x} is off by {off}");
        }
        assert!(exp(-1e9) == exp(-87.0) && exp(1e9) == exp(88.0) && exp(f32::NAN).is_nan());
    }
}
