use serde::{Deserialize, Serialize};

use crate::distance::metric::Metric;
use crate::error::{Error, Result};
use crate::limits::SUM_TOLERANCE;
use crate::samples;

/// A mixture of Gaussians with diagonal covariances.
///
/// Serialised as its parts, and checked as in [`GaussianMixture::from_parts`] when it is read back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MixtureParts", into = "MixtureParts")]
pub struct GaussianMixture {
    parts: MixtureParts,
    /// log w − ½ Σ log 2πv of each component.
    heights: Vec<f64>,
}

/// What a mixture is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MixtureParts {
    /// The length of a vector.
    pub dim: usize,
    /// The K components' weights, positive, with a sum of 1.
    pub weights: Vec<f64>,
    /// Their means, one after the other, K × dim.
    pub means: Vec<f32>,
    /// Their variances in each direction, positive, K × dim.
    pub variances: Vec<f32>,
}

impl GaussianMixture {
    /// Puts a mixture together.
    ///
    /// # Errors
    /// No components, means or variances of another number than the weights ask for, weights that
    /// are not positive or do not sum to 1 within [`SUM_TOLERANCE`](crate::SUM_TOLERANCE), means or
    /// variances that are not finite, and variances that are not positive.
    ///
    /// ```
    /// use phalanx_codebook::{GaussianMixture, MixtureParts};
    ///
    /// let parts = MixtureParts {
    ///     dim: 2,
    ///     weights: vec![0.25, 0.75],
    ///     means: vec![0.0, 0.0, 3.0, 4.0],
    ///     variances: vec![1.0; 4],
    /// };
    /// let mixture = GaussianMixture::from_parts(parts.clone())?;
    /// assert_eq!((mixture.len(), mixture.dim()), (2, 2));
    /// assert!(GaussianMixture::from_parts(MixtureParts { weights: vec![0.5, 0.6], ..parts }).is_err());
    /// # Ok::<(), phalanx_codebook::Error>(())
    /// ```
    pub fn from_parts(parts: MixtureParts) -> Result<Self> {
        let MixtureParts { dim, ref weights, ref means, ref variances } = parts;
        samples::check(Metric::Euclidean, "mean", means, dim)?;
        for (what, values) in [("mean", means), ("variance", variances)] {
            if values.len() != weights.len().saturating_mul(dim) {
                return Err(Error::Shape { what, values: values.len(), dim });
            }
        }
        if let Some(at) = variances.iter().position(|v| !v.is_normal() || *v < 0.0) {
            let (index, bin, value) = (at / dim, at % dim, variances[at]);
            return Err(Error::BadHeight { what: "variance", index, bin, value });
        }
        let sum: f64 = weights.iter().sum();
        if !weights.iter().all(|&w| w > 0.0) || (sum - 1.0).abs() > SUM_TOLERANCE {
            return Err(Error::BadWeights { sum });
        }
        let height = |(weight, variances): (&f64, &[f32])| {
            let logs = variances.iter().map(|&v| (std::f64::consts::TAU * f64::from(v)).ln());
            weight.ln() - 0.5 * logs.sum::<f64>()
        };
        let heights = weights.iter().zip(variances.chunks_exact(dim)).map(height).collect();
        Ok(Self { parts, heights })
    }

    /// What it is made of.
    pub fn parts(&self) -> &MixtureParts {
        &self.parts
    }

    /// The number K of components, at least 1.
    #[allow(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.parts.weights.len()
    }

    /// The length of a vector.
    pub fn dim(&self) -> usize {
        self.parts.dim
    }

    /// The mean and the variances of a component.
    pub(crate) fn component(&self, index: usize) -> (&[f32], &[f32]) {
        let dim = self.dim();
        let at = index * dim..(index + 1) * dim;
        (&self.parts.means[at.clone()], &self.parts.variances[at])
    }

    /// How likely it is, of a sample, that each component made it: K numbers with a sum of 1.
    /// Returns the log density of the sample.
    pub(crate) fn responsibilities(&self, sample: &[f32], out: &mut Vec<f64>) -> f64 {
        out.clear();
        out.extend((0..self.len()).map(|k| {
            let (mean, variance) = self.component(k);
            let squares = sample.iter().zip(mean).zip(variance).map(|((&x, &m), &v)| {
                let difference = f64::from(x) - f64::from(m);
                difference * difference / f64::from(v)
            });
            self.heights[k] - 0.5 * squares.sum::<f64>()
        }));
        let highest = out.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut sum = 0.0;
        for value in out.iter_mut() {
            *value = (*value - highest).exp();
            sum += *value;
        }
        for value in out {
            *value /= sum;
        }
        highest + sum.ln()
    }
}

impl TryFrom<MixtureParts> for GaussianMixture {
    type Error = Error;

    fn try_from(parts: MixtureParts) -> Result<Self> {
        Self::from_parts(parts)
    }
}

impl From<GaussianMixture> for MixtureParts {
    fn from(mixture: GaussianMixture) -> Self {
        mixture.parts
    }
}
