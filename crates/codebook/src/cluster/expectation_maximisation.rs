//! Mixtures of Gaussians by expectation maximisation (Dempster, Laird and Rubin, 1977).

use rayon::prelude::*;

use crate::cluster::gaussian_mixture::{GaussianMixture, MixtureParts};
use crate::cluster::kmeans::KMeans;
use crate::cluster::lloyd::BLOCK;
use crate::distance::metric::Metric;
use crate::error::{Error, Result};

/// The settings with which a [`GaussianMixture`] is found, and [`fit`](Self::fit).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectationMaximisation {
    /// The number K of components, at least 1.
    pub components: usize,
    /// How many times at most to move them, at least 1.
    pub max_iterations: usize,
    /// Stop once the mean log density of the samples rises by no more than this, in nats.
    pub tolerance: f64,
    /// The least variance in a direction, as a share of the samples' variance, 1e-6 to 1.
    pub variance_floor: f64,
    /// What the first means are drawn with.
    pub seed: u64,
}

impl Default for ExpectationMaximisation {
    /// Sixteen components, at most 100 iterations, to 1e-3 nats, a floor of 1e-2.
    fn default() -> Self {
        Self { components: 16, max_iterations: 100, tolerance: 1e-3, variance_floor: 1e-2, seed: 0 }
    }
}

/// Iterations of K-means to begin with.
const WARM_UP: usize = 10;

/// Far above the least number of single precision, so that shares of it are numbers too.
const LEAST_VARIANCE: f64 = 1e-30;

/// A component that explains fewer samples than this stays where it is.
const FEW: f64 = 1e-3;

impl ExpectationMaximisation {
    /// Finds a mixture for vectors of `dim` numbers, given one after the other, beginning with
    /// K-means' centres. Runs in rayon's current thread pool; the same bits in any.
    ///
    /// # Errors
    /// A setting outside its range, no samples, not a whole number of them, one with a number that
    /// is not finite, or fewer different samples than components.
    ///
    /// ```
    /// use phalanx_codebook::ExpectationMaximisation;
    ///
    /// let samples = [0.0, 0.2, 0.1, 5.0, 5.2]; // three here, two there
    /// let em = ExpectationMaximisation { components: 2, ..Default::default() };
    /// let mixture = em.fit(&samples, 1)?;
    /// let mut weights = mixture.parts().weights.clone();
    /// weights.sort_by(f64::total_cmp);
    /// assert!((weights[0] - 0.4).abs() < 1e-3 && (weights[1] - 0.6).abs() < 1e-3);
    /// # Ok::<(), phalanx_codebook::Error>(())
    /// ```
    pub fn fit(&self, samples: &[f32], dim: usize) -> Result<GaussianMixture> {
        self.check()?;
        let kmeans = KMeans {
            centres: self.components,
            restarts: 1,
            max_iterations: WARM_UP,
            seed: self.seed,
            metric: Metric::Euclidean,
            ..KMeans::default()
        };
        let means = kmeans.fit(samples, dim)?.codebook.centres().to_vec();
        let spread = spread(samples, dim);
        let floors: Vec<f64> = spread.iter().map(|v| self.variance_floor * v).collect();
        let variances: Vec<f32> = spread.iter().map(|&v| v as f32).collect();
        let mut mixture = GaussianMixture::from_parts(MixtureParts {
            dim,
            weights: vec![1.0 / self.components as f64; self.components],
            variances: variances.repeat(self.components),
            means,
        })?;
        let mut last = f64::NEG_INFINITY;
        for _ in 0..self.max_iterations {
            let sums = Sums::new(&mixture, samples);
            let density = sums.log_density / (samples.len() / dim) as f64;
            mixture = sums.mixture(&mixture, &floors)?;
            if density - last <= self.tolerance {
                break;
            }
            last = density;
        }
        Ok(mixture)
    }

    fn check(&self) -> Result<()> {
        let outside = |name, must_be| Err(Error::Parameter { name, must_be });
        match *self {
            Self { components: 0, .. } => outside("components", "at least 1"),
            Self { max_iterations: 0, .. } => outside("max_iterations", "at least 1"),
            Self { tolerance, .. } if tolerance.is_nan() || tolerance < 0.0 => {
                outside("tolerance", "at least 0")
            }
            Self { variance_floor, .. } if !(1e-6..=1.0).contains(&variance_floor) => {
                outside("variance_floor", "between 1e-6 and 1")
            }
            _ => Ok(()),
        }
    }
}

/// A direction in which the samples vary less than this share of their mean variance counts as one
/// in which they vary so much.
const FLAT: f64 = 1e-3;

/// The samples' variance in each direction, nowhere zero.
fn spread(samples: &[f32], dim: usize) -> Vec<f64> {
    let count = (samples.len() / dim) as f64;
    let mut means = vec![0.0; dim];
    for sample in samples.chunks_exact(dim) {
        means.iter_mut().zip(sample).for_each(|(mean, &x)| *mean += f64::from(x) / count);
    }
    let mut variances = vec![0.0; dim];
    for sample in samples.chunks_exact(dim) {
        for ((variance, mean), &x) in variances.iter_mut().zip(&means).zip(sample) {
            *variance += (f64::from(x) - mean).powi(2) / count;
        }
    }
    let mean = variances.iter().sum::<f64>() / dim as f64;
    let least = (FLAT * mean).max(LEAST_VARIANCE);
    variances.into_iter().map(|variance| variance.max(least)).collect()
}

/// What the samples say of each component.
struct Sums {
    log_density: f64,
    counts: Vec<f64>,
    /// Σ γ (x − μ) about the present means.
    firsts: Vec<f64>,
    /// Σ γ (x − μ)².
    seconds: Vec<f64>,
}

impl Sums {
    fn empty(mixture: &GaussianMixture) -> Self {
        let (count, numbers) = (mixture.len(), mixture.len() * mixture.dim());
        Self {
            log_density: 0.0,
            counts: vec![0.0; count],
            firsts: vec![0.0; numbers],
            seconds: vec![0.0; numbers],
        }
    }

    fn new(mixture: &GaussianMixture, samples: &[f32]) -> Self {
        let blocks: Vec<Self> = samples
            .par_chunks(BLOCK * mixture.dim())
            .map(|samples| Self::of_block(mixture, samples))
            .collect();
        blocks.into_iter().fold(Self::empty(mixture), Self::join)
    }

    fn of_block(mixture: &GaussianMixture, samples: &[f32]) -> Self {
        let dim = mixture.dim();
        let (mut sums, mut shares) = (Self::empty(mixture), Vec::new());
        for sample in samples.chunks_exact(dim) {
            sums.log_density += mixture.responsibilities(sample, &mut shares);
            for (k, &share) in shares.iter().enumerate() {
                sums.counts[k] += share;
                let (mean, _) = mixture.component(k);
                let at = k * dim..(k + 1) * dim;
                let of_component = sums.firsts[at.clone()].iter_mut().zip(&mut sums.seconds[at]);
                for ((first, second), (&x, &m)) in of_component.zip(sample.iter().zip(mean)) {
                    let difference = f64::from(x) - f64::from(m);
                    *first += share * difference;
                    *second += share * difference * difference;
                }
            }
        }
        sums
    }

    fn join(mut self, other: Self) -> Self {
        let add = |a: &mut [f64], b: Vec<f64>| a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        self.log_density += other.log_density;
        add(&mut self.counts, other.counts);
        add(&mut self.firsts, other.firsts);
        add(&mut self.seconds, other.seconds);
        self
    }

    /// The mixture of the greatest expected likelihood, with variances above their floors.
    fn mixture(&self, old: &GaussianMixture, floors: &[f64]) -> Result<GaussianMixture> {
        let dim = old.dim();
        let mut parts = old.parts().clone();
        for (k, &count) in self.counts.iter().enumerate().filter(|(_, count)| **count > FEW) {
            for (i, at) in (k * dim..(k + 1) * dim).enumerate() {
                let moved = self.firsts[at] / count;
                let variance = self.seconds[at] / count - moved * moved;
                parts.means[at] = (f64::from(parts.means[at]) + moved) as f32;
                parts.variances[at] = variance.max(floors[i]) as f32;
            }
        }
        let counts = self.counts.iter().map(|count| count.max(FEW));
        let total: f64 = counts.clone().sum();
        parts.weights = counts.map(|count| count / total).collect();
        GaussianMixture::from_parts(parts)
    }
}
