//! Adam (Kingma and Ba 2015).

use rayon::prelude::*;

/// Decay rates of the moving averages.
const MEAN: f64 = 0.9;
const SQUARE: f64 = 0.999;
/// Added to the denominator.
const LEAST: f64 = 1e-8;
/// Weights updated by one task.
const BLOCK: usize = 1 << 14;

pub(super) struct Adam {
    steps: usize,
    mean: Vec<f32>,
    square: Vec<f32>,
}

impl Adam {
    pub(super) fn new(weights: usize) -> Self {
        Self { steps: 0, mean: vec![0.0; weights], square: vec![0.0; weights] }
    }

    /// Steps taken so far.
    pub(super) fn steps(&self) -> usize {
        self.steps
    }

    /// One step at a learning rate. The gradient comes in parts, which are added in order.
    pub(super) fn step(&mut self, weights: &mut [f32], slopes: &[&[f32]], rate: f64) {
        self.steps += 1;
        // Corrects the bias of averages that start at zero.
        let sofar = |share: f64| 1.0 - share.powi(i32::try_from(self.steps).unwrap_or(i32::MAX));
        let (rate, root) = ((rate / sofar(MEAN)) as f32, sofar(SQUARE).sqrt().recip() as f32);
        let means = self.mean.par_chunks_mut(BLOCK).zip(self.square.par_chunks_mut(BLOCK));
        let blocks = weights.par_chunks_mut(BLOCK).zip(means).enumerate();
        blocks.for_each(|(block, (weights, (mean, square)))| {
            let (keep, keep_square, least) = (MEAN as f32, SQUARE as f32, LEAST as f32);
            let mut sums = vec![0.0; weights.len()];
            for slopes in slopes {
                let slopes = &slopes[block * BLOCK..];
                sums.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += slope);
            }
            let all = weights.iter_mut().zip(sums).zip(mean).zip(square);
            for (((weight, slope), mean), square) in all {
                *mean = keep * *mean + (1.0 - keep) * slope;
                *square = keep_square * *square + (1.0 - keep_square) * slope * slope;
                *weight -= rate * *mean / (square.sqrt() * root + least);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_in_parts_are_added() {
        let count = BLOCK + 100;
        let parts: Vec<Vec<f32>> =
            (1..4).map(|k| (0..count).map(|i| ((i * k) % 17) as f32 - 8.0).collect()).collect();
        let sum: Vec<f32> = (0..count).map(|i| parts.iter().map(|part| part[i]).sum()).collect();
        let stepped = |slopes: &[&[f32]]| {
            let mut weights = vec![1.0; count];
            let mut adam = Adam::new(count);
            adam.step(&mut weights, slopes, 0.1);
            adam.step(&mut weights, slopes, 0.1);
            weights
        };
        let parts: Vec<&[f32]> = parts.iter().map(Vec::as_slice).collect();
        assert_eq!(stepped(&parts), stepped(&[&sum]));
    }
}
