//! The evidence of a fixed set of vectors as a function of widths and precisions, and its gradient.

use faer::{Mat, MatRef};

use crate::linalg;

/// The prior adds a unit to the system of the weights: where rounding errors are more than this, little is left of it,
/// and another order of the same sums may find the system singular.
const LOST: f64 = 1e-3;

/// The evidence of targets that share their vectors, in log widths and log precisions.
pub(super) struct Widths<'a> {
    /// Standardised inputs, K×n.
    pub(super) z: MatRef<'a, f64>,
    /// Standardised targets that vary, n×m.
    pub(super) y: MatRef<'a, f64>,
    /// Which width each input has.
    pub(super) ties: &'a [usize],
    /// Number of widths.
    pub(super) count: usize,
    /// The samples that are vectors.
    pub(super) vectors: &'a [usize],
    /// Least noise variance.
    pub(super) floor: f64,
}

/// The Gaussians at some widths.
struct Gaussians {
    /// exp(−Σ w (z − c)²), n×p.
    raw: Mat<f64>,
    /// The same with every column's mean subtracted.
    centred: Mat<f64>,
}

impl Widths<'_> {
    /// The log evidence in nats, with every target's noise where it is greatest, and its gradient,
    /// at the logs of the widths and then of the vectors' precisions (relative to the noise).
    /// `None` where it cannot be computed.
    pub(super) fn evaluate(&self, at: &[f64]) -> Option<(f64, Vec<f64>)> {
        let widths: Vec<f64> = self.ties.iter().map(|&tie| at[tie].exp()).collect();
        let alpha: Vec<f64> = at[self.count..].iter().map(|log| log.exp()).collect();
        if !widths.iter().chain(&alpha).all(|v| v.is_finite()) || alpha.contains(&0.0) {
            return None;
        }
        let Gaussians { raw, centred } = self.gaussians(&widths);
        let (n, m, p) = (self.y.nrows(), self.y.ncols(), self.vectors.len());
        let freedom = n as f64 - 1.0;
        let d: Vec<f64> = alpha.iter().map(|a| a.sqrt().recip()).collect();
        let gram = linalg::gram(centred.as_ref());
        let system = Mat::from_fn(p, p, |i, k| {
            let unit = if i == k { 1.0 } else { 0.0 };
            d[i] * gram[(i, k)] * d[k] + unit
        });
        let greatest = (0..p).map(|k| system[(k, k)]).fold(0.0, f64::max);
        if greatest * f64::EPSILON > LOST {
            return None;
        }
        let cholesky = linalg::cholesky(system)?;
        let mut factor = linalg::lower_inverse(cholesky.as_ref());
        for (k, d) in d.iter().enumerate() {
            factor.col_as_slice_mut(k).iter_mut().for_each(|v| *v *= d);
        }
        let half =
            linalg::product(factor.as_ref(), linalg::product(centred.transpose(), self.y).as_ref());
        let mu = linalg::product(factor.transpose(), half.as_ref());
        let sigma = linalg::gram(factor.as_ref());
        let misfits: Vec<f64> = (0..m)
            .map(|j| (self.y.col(j).squared_norm_l2() - half.col(j).squared_norm_l2()).max(0.0))
            .collect();
        let noise: Vec<f64> = misfits.iter().map(|v| (v / freedom).max(self.floor)).collect();
        let log_determinant: f64 = (0..p).map(|k| 2.0 * cholesky[(k, k)].ln()).sum();
        let normal: f64 = misfits
            .iter()
            .zip(&noise)
            .map(|(misfit, noise)| freedom * (std::f64::consts::TAU * noise).ln() + misfit / noise)
            .sum();
        let value = -0.5 * (normal + m as f64 * log_determinant);

        // By the Gaussians: Σⱼ (yⱼ − Φμⱼ)μⱼᵀ/σⱼ² − m ΦΣ.
        let residuals = self.y - linalg::product(centred.as_ref(), mu.as_ref());
        let precise = Mat::from_fn(m, p, |j, k| mu[(k, j)] / noise[j]);
        let by_gaussians = linalg::product(residuals.as_ref(), precise.as_ref())
            - faer::Scale(m as f64) * linalg::product(centred.as_ref(), sigma.as_ref());
        let mut gradient = self.by_widths(&widths, &raw, &by_gaussians);
        gradient.extend((0..p).map(|k| {
            let size: f64 = (0..m).map(|j| mu[(k, j)].powi(2) / noise[j]).sum();
            0.5 * (m as f64 - alpha[k] * (m as f64 * sigma[(k, k)] + size))
        }));
        (value.is_finite() && gradient.iter().all(|g| g.is_finite())).then_some((value, gradient))
    }

    fn gaussians(&self, widths: &[f64]) -> Gaussians {
        let scaled =
            Mat::from_fn(self.z.nrows(), self.z.ncols(), |i, t| widths[i].sqrt() * self.z[(i, t)]);
        let centres =
            Mat::from_fn(scaled.nrows(), self.vectors.len(), |i, k| scaled[(i, self.vectors[k])]);
        let mut raw = linalg::product(scaled.transpose(), centres.as_ref());
        let norms: Vec<f64> = scaled.col_iter().map(|z| z.squared_norm_l2()).collect();
        for (k, &vector) in self.vectors.iter().enumerate() {
            for (value, norm) in raw.col_as_slice_mut(k).iter_mut().zip(&norms) {
                *value = (-(norm + norms[vector] - 2.0 * *value).max(0.0)).exp();
            }
        }
        let mut centred = raw.clone();
        linalg::centre(&mut centred);
        Gaussians { raw, centred }
    }

    /// The chain rule from the Gaussians to the log widths: −w Σ E φ (z − c)² for each input.
    fn by_widths(&self, widths: &[f64], raw: &Mat<f64>, by_gaussians: &Mat<f64>) -> Vec<f64> {
        let (n, p) = raw.shape();
        let weights = Mat::from_fn(n, p, |t, k| by_gaussians[(t, k)] * raw[(t, k)]);
        let of_samples: Vec<f64> = (0..n).map(|t| weights.row(t).iter().sum()).collect();
        let of_vectors: Vec<f64> = weights.col_iter().map(|column| column.sum()).collect();
        let crossed = linalg::product(self.z, weights.as_ref());
        let mut gradient = vec![0.0; self.count];
        for (i, (&tie, width)) in self.ties.iter().zip(widths).enumerate() {
            let mut sum = 0.0;
            for (t, weight) in of_samples.iter().enumerate() {
                sum += weight * self.z[(i, t)].powi(2);
            }
            for (k, &vector) in self.vectors.iter().enumerate() {
                let centre = self.z[(i, vector)];
                sum += centre * (of_vectors[k] * centre - 2.0 * crossed[(i, k)]);
            }
            gradient[tie] -= width * sum;
        }
        gradient
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand_core::Rng;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    proptest! {
        #![proptest_config(crate::property::cases(48))]

        #[test]
        fn the_gradient_is_that_of_central_differences(seed in any::<u64>(), floor in 1e-6..0.5_f64) {
            let mut random = Pcg64Mcg::new(u128::from(seed) | 1);
            let mut uniform = || 2.0 * f64::from(random.next_u32()) / f64::from(u32::MAX) - 1.0;
            let z = Mat::from_fn(4, 30, |_, _| 1.7 * uniform());
            let mut y = Mat::from_fn(30, 2, |t, j| z[(j, t)].sin() + 0.3 * uniform());
            linalg::centre(&mut y);
            let widths = Widths {
                z: z.as_ref(),
                y: y.as_ref(),
                ties: &[0, 1, 1, 2],
                count: 3,
                vectors: &[3, 7, 20, 11, 29],
                floor,
            };
            let at: Vec<f64> = (0..8).map(|_| 2.0 * uniform() - 0.5).collect();
            let (_, gradient) = widths.evaluate(&at).unwrap();
            for (k, slope) in gradient.iter().enumerate() {
                let moved = |by: f64| {
                    let mut at = at.clone();
                    at[k] += by;
                    widths.evaluate(&at).unwrap().0
                };
                let step = 1e-5;
                let difference = (moved(step) - moved(-step)) / (2.0 * step);
                prop_assert!((slope - difference).abs() < 1e-5 * (1.0 + slope.abs()), "{k}: {slope} {difference}");
            }
        }
    }
}
