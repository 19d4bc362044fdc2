use pulp::Arch;
use serde::{Deserialize, Serialize};

use crate::distance::lanes::{LANES, Lanes};
use crate::distance::metric::Metric;
use crate::distance::packed::Packed;
use crate::distance::support::Support;
use crate::error::{Error, Result};
use crate::samples;

/// Vectors that stand for those around them.
///
/// Serialised as its parts, and checked as in [`Codebook::from_parts`] when it is read back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct Codebook {
    metric: Metric,
    centres: Vec<f32>,
    dim: usize,
    scale: f64,
    pub(crate) packed: Packed,
}

/// Below this scale, exp(−χ²/s) would see the rounding of χ².
const MIN_CHI_SQUARED: f64 = 1e-6;

/// The centre nearest to a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Its index; the first of equals.
    pub centre: usize,
    /// The distance of the two, as the codebook's metric has it.
    pub distance: f32,
}

impl Codebook {
    /// A codebook of centres given one after the other, each a histogram of `dim` bins, that
    /// compares by χ².
    ///
    /// `scale` is s, the χ² at which a vote's weight has fallen to 1/e.
    ///
    /// # Errors
    /// No centres, not a whole number of them, one that is not a histogram that sums to 1 within
    /// [`SUM_TOLERANCE`](crate::SUM_TOLERANCE), or a scale that is not finite and positive.
    ///
    /// ```
    /// use phalanx_codebook::Codebook;
    ///
    /// let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.25, 0.75], 2, 0.1)?;
    /// assert_eq!((codebook.len(), codebook.dim()), (2, 2));
    /// assert_eq!(codebook.nearest(&[0.3, 0.7])?.centre, 1);
    /// # Ok::<(), phalanx_codebook::Error>(())
    /// ```
    pub fn from_parts(centres: Vec<f32>, dim: usize, scale: f64) -> Result<Self> {
        Self::with_metric(Metric::ChiSquared, centres, dim, scale)
    }

    /// A codebook like [`from_parts`](Self::from_parts)'s that compares by another metric, whose
    /// distance `scale` is.
    ///
    /// # Errors
    /// As of [`from_parts`](Self::from_parts); of the Euclidean metric's centres, numbers that are
    /// not finite or beyond [`MAX_MAGNITUDE`](crate::MAX_MAGNITUDE).
    ///
    /// ```
    /// use phalanx_codebook::{Codebook, Metric};
    ///
    /// let corners = vec![-5.0, 0.0, 5.0, 0.0];
    /// let codebook = Codebook::with_metric(Metric::Euclidean, corners, 2, 1.0)?;
    /// assert_eq!(codebook.nearest(&[4.0, 1.0])?.distance, 2.0);
    /// # Ok::<(), phalanx_codebook::Error>(())
    /// ```
    pub fn with_metric(metric: Metric, centres: Vec<f32>, dim: usize, scale: f64) -> Result<Self> {
        samples::check(metric, "centre", &centres, dim)?;
        if !(scale.is_finite() && scale > 0.0) {
            return Err(Error::BadScale { scale });
        }
        let packed = Packed::new(metric, &centres, dim);
        Ok(Self { metric, centres, dim, scale, packed })
    }

    /// A codebook whose scale is what its samples' mean distance came to.
    pub(crate) fn from_fit(
        metric: Metric,
        centres: Vec<f32>,
        dim: usize,
        distortion: f64,
    ) -> Result<Self> {
        let least = match metric {
            Metric::ChiSquared => MIN_CHI_SQUARED,
            Metric::Euclidean => f64::from(f32::MIN_POSITIVE),
        };
        Self::with_metric(metric, centres, dim, distortion.max(least))
    }

    /// How vectors are compared.
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// The centres one after the other, [`len`](Self::len) × [`dim`](Self::dim) numbers.
    pub fn centres(&self) -> &[f32] {
        &self.centres
    }

    /// The number K of centres, at least 1.
    #[allow(clippy::len_without_is_empty, reason = "never empty")]
    pub fn len(&self) -> usize {
        self.centres.len() / self.dim
    }

    /// The length of a vector: the bins of a histogram.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The scale s of the votes: the mean distance of the training samples to their nearest
    /// centres.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The centre nearest to one sample.
    ///
    /// # Errors
    /// A sample of another length than [`dim`](Self::dim), or that the metric cannot compare: for χ²
    /// one that is not a histogram that sums to 1.
    ///
    /// ```
    /// use phalanx_codebook::{Codebook, Metric};
    ///
    /// let towns = vec![0.0, 0.0, 10.0, 0.0, 0.0, 10.0];
    /// let codebook = Codebook::with_metric(Metric::Euclidean, towns, 2, 1.0)?;
    /// let nearest = codebook.nearest(&[1.0, 7.0])?;
    /// assert_eq!((nearest.centre, nearest.distance), (2, 10.0));
    /// # Ok::<(), phalanx_codebook::Error>(())
    /// ```
    pub fn nearest(&self, sample: &[f32]) -> Result<Nearest> {
        if sample.len() != self.dim {
            return Err(Error::Shape { what: "sample", values: sample.len(), dim: self.dim });
        }
        samples::check(self.metric, "sample", sample, self.dim)?;
        let (mut support, mut distances) = (Support::default(), Vec::new());
        self.packed.load(sample, &mut support);
        let distance = self.packed.whole().compare(Arch::new(), &support, &mut distances);
        Ok(Nearest { centre: first_equal(&distances, distance), distance })
    }
}

/// The index of the first distance that is the smallest one; the distances are those of whole blocks.
pub(crate) fn first_equal(distances: &[f32], smallest: f32) -> usize {
    let (blocks, _) = distances.as_chunks::<LANES>();
    // A whole block at once, without a branch for each distance.
    let is_in =
        |block: &Lanes| block.iter().fold(0, |found, &d| found | u8::from(d == smallest)) != 0;
    let block = blocks.iter().position(is_in).unwrap_or_default();
    let lane = blocks[block].iter().position(|&d| d == smallest).unwrap_or_default();
    block * LANES + lane
}

/// What is stored of a codebook.
#[derive(Serialize, Deserialize)]
struct Parts {
    metric: Metric,
    dim: usize,
    scale: f64,
    centres: Vec<f32>,
}

impl TryFrom<Parts> for Codebook {
    type Error = Error;

    fn try_from(parts: Parts) -> Result<Self> {
        Self::with_metric(parts.metric, parts.centres, parts.dim, parts.scale)
    }
}

impl From<Codebook> for Parts {
    fn from(codebook: Codebook) -> Self {
        let Codebook { metric, dim, scale, centres, .. } = codebook;
        Self { metric, dim, scale, centres }
    }
}
