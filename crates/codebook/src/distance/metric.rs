use serde::{Deserialize, Serialize};

use crate::distance::chi_squared::chi_squared;

/// What the distance of two vectors is. Both are squares already.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Metric {
    /// The χ² statistic of histograms that sum to 1; see [`chi_squared`].
    #[default]
    ChiSquared,
    /// The squared Euclidean distance of any vectors; see [`squared_euclidean`].
    Euclidean,
}

impl Metric {
    /// The distance of two vectors of the same length, in double precision.
    ///
    /// ```
    /// use phalanx_codebook::Metric;
    ///
    /// let (a, b) = ([1.0, 0.0], [0.0, 1.0]);
    /// assert_eq!(Metric::ChiSquared.distance(&a, &b), 1.0);
    /// assert_eq!(Metric::Euclidean.distance(&a, &b), 2.0);
    /// ```
    pub fn distance(self, a: &[f32], b: &[f32]) -> f64 {
        match self {
            Self::ChiSquared => chi_squared(a, b),
            Self::Euclidean => squared_euclidean(a, b),
        }
    }
}

/// The squared Euclidean distance of two vectors, Σ (a − b)².
///
/// Numbers beyond the end of the shorter one are not looked at.
///
/// ```
/// assert_eq!(phalanx_codebook::squared_euclidean(&[0.0, 3.0], &[4.0, 0.0]), 25.0);
/// ```
pub fn squared_euclidean(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2)).sum()
}
