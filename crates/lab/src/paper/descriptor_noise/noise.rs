//! Noise on descriptors.

use faer::Mat;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// What is done to the test descriptors. Each view's histogram sums to 1 before and after.
#[derive(Clone, Copy)]
pub(super) enum Noise {
    /// Each histogram is drawn anew as so many whole votes, with its bins as probabilities: the
    /// noise of a contour of so many independent points.
    Votes(usize),
    /// A normal deviate of so many of the bin's standard deviations in training is added to each
    /// bin, bins below 0 are emptied, and the histogram normalised.
    Deviations(f64),
}

impl Noise {
    /// The place of a level on its plot's axis.
    pub(super) fn level(self) -> f64 {
        match self {
            Self::Votes(votes) => 1.0 / (votes as f64).sqrt(),
            Self::Deviations(deviations) => deviations,
        }
    }

    pub(super) fn words(self) -> String {
        match self {
            Self::Votes(votes) => format!("{votes} votes"),
            Self::Deviations(deviations) => format!("{deviations} σ"),
        }
    }

    /// Disturbs one view's histogram.
    fn disturb(self, histogram: &mut [f64], deviations: &[f64], random: &mut Pcg64Mcg) {
        match self {
            Self::Votes(votes) => {
                let bounds: Vec<f64> = histogram
                    .iter()
                    .scan(0.0, |sum, part| {
                        *sum += part;
                        Some(*sum)
                    })
                    .collect();
                histogram.fill(0.0);
                let last = histogram.len() - 1;
                for _ in 0..votes {
                    let place = uniform(random) * bounds[last];
                    let bin = bounds.partition_point(|bound| *bound <= place);
                    histogram[bin.min(last)] += 1.0 / votes as f64;
                }
            }
            Self::Deviations(level) => {
                for (part, deviation) in histogram.iter_mut().zip(deviations) {
                    *part = (*part + level * deviation * normal(random)).max(0.0);
                }
                let sum: f64 = histogram.iter().sum();
                for part in histogram {
                    *part /= sum;
                }
            }
        }
    }

    /// All samples disturbed, each by its own random numbers.
    pub(super) fn on(self, x: &Mat<f64>, deviations: &[f64], views: usize, seed: u64) -> Mat<f64> {
        let mut disturbed = x.clone();
        let bins = x.nrows() / views;
        for sample in 0..x.ncols() {
            let mut random = Pcg64Mcg::seed_from_u64(seed << 32 | sample as u64);
            let column = disturbed.col_mut(sample).try_as_col_major_mut();
            let column = column.expect("an owned matrix is stored by columns").as_slice_mut();
            for (histogram, deviations) in column.chunks_mut(bins).zip(deviations.chunks(bins)) {
                self.disturb(histogram, deviations, &mut random);
            }
        }
        disturbed
    }
}

/// From 0 up to, and without, 1.
fn uniform(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// A standard normal deviate (Box and Muller 1958).
fn normal(random: &mut Pcg64Mcg) -> f64 {
    let radius = (-2.0 * (1.0 - uniform(random)).ln()).sqrt();
    radius * (std::f64::consts::TAU * uniform(random)).cos()
}

/// The standard deviation of each row.
pub(super) fn deviations(x: &Mat<f64>) -> Vec<f64> {
    let count = x.ncols() as f64;
    let deviation = |k: usize| {
        let mean = x.row(k).iter().sum::<f64>() / count;
        (x.row(k).iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
    };
    (0..x.nrows()).map(deviation).collect()
}

/// The root mean square of a change over some rows, in their standard deviations.
pub(super) fn shift(change: &Mat<f64>, rows: &[usize], deviations: &[f64]) -> f64 {
    let squares = rows
        .iter()
        .flat_map(|&k| change.row(k).iter().map(move |value| (value / deviations[k]).powi(2)));
    (squares.sum::<f64>() / (rows.len() * change.ncols()) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_keeps_histograms_and_more_votes_disturb_less() {
        let x = Mat::from_fn(6, 40, |k, i| [0.5, 0.3, 0.2][(k + i) % 3]);
        let deviations = deviations(&x);
        let distance = |noise: Noise| {
            let noisy = noise.on(&x, &deviations, 2, 7);
            for i in 0..x.ncols() {
                for view in [0..3, 3..6] {
                    let sum: f64 = view.map(|k| noisy[(k, i)]).sum();
                    assert!((sum - 1.0).abs() < 1e-12);
                }
            }
            (&noisy - &x).norm_l2()
        };
        assert!(distance(Noise::Votes(3000)) < distance(Noise::Votes(30)));
        assert!(distance(Noise::Deviations(0.1)) < distance(Noise::Deviations(0.8)));
        assert_eq!(distance(Noise::Deviations(0.0)), 0.0);
    }
}
