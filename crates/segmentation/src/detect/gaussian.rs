//! A normal distribution of a few numbers.

use crate::detect::cross_sections::FEATURES;

/// Numbers that describe a section.
pub(crate) type Features = [f64; FEATURES];

/// A normal distribution.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gaussian {
    mean: Features,
    /// The covariance's Cholesky factor, lower.
    factor: [Features; FEATURES],
    /// −½ log det(2π covariance).
    height: f64,
}

impl Gaussian {
    /// From mean and covariance; `None` unless it is positive definite and all is finite.
    pub(crate) fn new(mean: Features, covariance: &[Features; FEATURES]) -> Option<Self> {
        let mut factor = [[0.0; FEATURES]; FEATURES];
        let mut height = 0.0;
        for i in 0..FEATURES {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let left = covariance[i][j] - known;
                factor[i][j] = if i == j { left.sqrt() } else { left / factor[j][j] };
            }
            height -= 0.5 * std::f64::consts::TAU.ln() + factor[i][i].ln();
        }
        let numbers = || mean.iter().chain(factor.as_flattened());
        // The root of what is not positive is NaN, or zero, whose logarithm is not finite.
        (height.is_finite() && numbers().all(|n| n.is_finite())).then_some(Self {
            mean,
            factor,
            height,
        })
    }

    /// Squared Mahalanobis distance.
    pub(crate) fn distance(&self, x: &Features) -> f64 {
        let mut z = [0.0; FEATURES];
        for i in 0..FEATURES {
            let known: f64 = (0..i).map(|k| self.factor[i][k] * z[k]).sum();
            z[i] = (x[i] - self.mean[i] - known) / self.factor[i][i];
        }
        z.iter().map(|z| z * z).sum()
    }

    /// Logarithm of the density.
    pub(crate) fn log_density(&self, x: &Features) -> f64 {
        self.height - 0.5 * self.distance(x)
    }
}

/// Sums that mean and covariance follow from.
#[derive(Debug, Clone, Default)]
pub(crate) struct Moments {
    count: f64,
    sum: Features,
    products: [Features; FEATURES],
}

impl Moments {
    pub(crate) fn add(&mut self, x: &Features) {
        self.count += 1.0;
        for i in 0..FEATURES {
            self.sum[i] += x[i];
            for j in 0..FEATURES {
                self.products[i][j] += x[i] * x[j];
            }
        }
    }

    /// Mean and covariance; the variances are raised by `floor`.
    pub(crate) fn finish(&self, floor: f64) -> (Features, [Features; FEATURES]) {
        let mean = self.sum.map(|sum| sum / self.count);
        let covariance = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let floor = if i == j { floor } else { 0.0 };
                self.products[i][j] / self.count - mean[i] * mean[j] + floor
            })
        });
        (mean, covariance)
    }
}
