//! One iteration of K-means (Lloyd, 1982): assign every sample, then move every centre.

use pulp::Arch;
use rayon::prelude::*;

use crate::codebook::first_equal;
use crate::distance::metric::Metric;
use crate::distance::packed::Packed;
use crate::distance::support::Support;

/// Samples that are summed up together. Fixed, so that the rounding of the sums does not depend on
/// the number of threads.
pub(crate) const BLOCK: usize = 2048;

/// What an assignment of the samples says of each centre.
pub(crate) struct Assignment {
    dim: usize,
    /// The sum of the samples of each centre.
    sums: Vec<f64>,
    /// Their number.
    counts: Vec<usize>,
    /// The sum of their distances to their centres.
    total: f64,
}

impl Assignment {
    fn empty(centres: usize, dim: usize) -> Self {
        Self { dim, sums: vec![0.0; centres * dim], counts: vec![0; centres], total: 0.0 }
    }

    /// Assigns each sample to its nearest centre, and writes the distance of the two.
    pub(crate) fn new(
        metric: Metric,
        samples: &[f32],
        dim: usize,
        centres: &[f32],
        distances: &mut [f32],
    ) -> Self {
        let packed = Packed::new(metric, centres, dim);
        let count = centres.len() / dim;
        let blocks: Vec<Self> = samples
            .par_chunks(BLOCK * dim)
            .zip(distances.par_chunks_mut(BLOCK))
            .map(|(samples, distances)| Self::of_block(samples, dim, &packed, count, distances))
            .collect();
        blocks.into_iter().fold(Self::empty(count, dim), Self::join)
    }

    fn of_block(
        samples: &[f32],
        dim: usize,
        packed: &Packed,
        count: usize,
        distances: &mut [f32],
    ) -> Self {
        let arch = Arch::new();
        let mut block = Self::empty(count, dim);
        let (mut support, mut to_centres) = (Support::default(), Vec::new());
        let mut nearest = Vec::with_capacity(BLOCK);
        for (sample, distance) in samples.chunks_exact(dim).zip(distances) {
            packed.load(sample, &mut support);
            *distance = packed.whole().compare(arch, &support, &mut to_centres);
            nearest.push(first_equal(&to_centres, *distance));
            block.total += f64::from(*distance);
        }
        // In a loop of its own: centres and sums together are more than the nearest cache holds.
        for (sample, centre) in samples.chunks_exact(dim).zip(nearest) {
            block.counts[centre] += 1;
            let sums = &mut block.sums[centre * dim..(centre + 1) * dim];
            for (sum, &height) in sums.iter_mut().zip(sample) {
                *sum += f64::from(height);
            }
        }
        block
    }

    fn join(mut self, other: Self) -> Self {
        self.total += other.total;
        self.sums.iter_mut().zip(other.sums).for_each(|(a, b)| *a += b);
        self.counts.iter_mut().zip(other.counts).for_each(|(a, b)| *a += b);
        self
    }

    /// The mean distance of the samples to their centres.
    pub(crate) fn distortion(&self) -> f64 {
        self.total / self.counts.iter().sum::<usize>() as f64
    }

    /// Moves each centre to the mean of its samples. One that has none moves to the sample that is
    /// served worst (the first of equals), the next such one to the second worst, and so on.
    ///
    /// Returns how many had none. Uses up the distances.
    pub(crate) fn move_centres(
        &self,
        samples: &[f32],
        centres: &mut [f32],
        distances: &mut [f32],
    ) -> usize {
        let mut empty = 0;
        let means = self.sums.chunks_exact(self.dim).zip(&self.counts);
        for (centre, (sums, &count)) in centres.chunks_exact_mut(self.dim).zip(means) {
            if count > 0 {
                for (height, sum) in centre.iter_mut().zip(sums) {
                    *height = (sum / count as f64) as f32;
                }
            } else {
                empty += 1;
                let worst = worst(distances);
                distances[worst] = 0.0;
                centre.copy_from_slice(&samples[worst * self.dim..(worst + 1) * self.dim]);
            }
        }
        empty
    }

    /// Moves each centre to the mean of its samples and of the `counts` that it has had before,
    /// which then count these too.
    pub(crate) fn draw_centres(&self, centres: &mut [f32], counts: &mut [usize]) {
        let sums = self.sums.chunks_exact(self.dim).zip(&self.counts);
        let centres = centres.chunks_exact_mut(self.dim).zip(counts);
        for ((centre, had), (sums, &new)) in centres.zip(sums) {
            *had += new;
            let had = (*had).max(1) as f64;
            for (value, sum) in centre.iter_mut().zip(sums) {
                *value += ((sum - new as f64 * f64::from(*value)) / had) as f32;
            }
        }
    }
}

/// The index of the largest distance, the first of equals.
fn worst(distances: &[f32]) -> usize {
    (0..distances.len()).fold(0, |worst, i| if distances[i] > distances[worst] { i } else { worst })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The second and third centre equal the first and lose every sample to it.
    #[test]
    fn empty_centres_move_to_the_worst_served_samples() {
        let samples = [[1.0, 0.0], [0.9, 0.1], [0.2, 0.8], [0.0, 1.0]].concat();
        let mut centres = [[1.0, 0.0]; 3].concat();
        let mut distances = [0.0; 4];
        let assignment = Assignment::new(Metric::ChiSquared, &samples, 2, &centres, &mut distances);
        assert_eq!(assignment.counts, [4, 0, 0]);
        assert_eq!(assignment.move_centres(&samples, &mut centres, &mut distances), 2);
        assert_eq!(centres, [[0.525, 0.475], [0.0, 1.0], [0.2, 0.8]].concat());
    }
}
