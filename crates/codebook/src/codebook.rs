use pulp::Arch;
use serde::{Deserialize, Serialize};

use crate::{
    Error, Result,
    packed::{Packed, Support},
    samples,
};

/// Histograms that stand for those around them.
///
/// Serialised as its parts, and checked as in [`Codebook::from_parts`] when it is read back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct Codebook {
    centres: Vec<f32>,
    dim: usize,
    scale: f64,
    pub(crate) packed: Packed,
}

/// The centre nearest to a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Its index; the first of equals.
    pub centre: usize,
    /// The χ² statistic of the two.
    pub chi_squared: f32,
}

impl Codebook {
    /// A codebook of centres given one after the other, each a histogram of `dim` bins.
    ///
    /// `scale` is s, the χ² at which a vote's weight has fallen to 1/e.
    ///
    /// # Errors
    /// No centres, not a whole number of them, one that is not a histogram that sums to 1 within
    /// [`SUM_TOLERANCE`](crate::SUM_TOLERANCE), or a scale that is not finite and positive.
    pub fn from_parts(centres: Vec<f32>, dim: usize, scale: f64) -> Result<Self> {
        samples::check("centre", &centres, dim)?;
        if !(scale.is_finite() && scale > 0.0) {
            return Err(Error::BadScale { scale });
        }
        let packed = Packed::new(&centres, dim);
        Ok(Self { centres, dim, scale, packed })
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

    /// The number of bins of a histogram.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The scale s of the votes: the mean χ² of the training samples to their nearest centres.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The centre nearest to one sample.
    ///
    /// # Errors
    /// A sample that is not one histogram of [`dim`](Self::dim) bins that sums to 1.
    pub fn nearest(&self, sample: &[f32]) -> Result<Nearest> {
        if sample.len() != self.dim {
            return Err(Error::Shape { what: "sample", values: sample.len(), dim: self.dim });
        }
        samples::check("sample", sample, self.dim)?;
        let (mut support, mut distances) = (Support::default(), Vec::new());
        support.find(sample);
        let chi_squared = self.packed.whole().compare(Arch::new(), &support, &mut distances);
        let centre = first_equal(&distances, chi_squared);
        Ok(Nearest { centre, chi_squared })
    }
}

/// The index of the first distance that is the smallest one.
pub(crate) fn first_equal(distances: &[f32], smallest: f32) -> usize {
    distances.iter().position(|&d| d == smallest).unwrap_or_default()
}

/// What is stored of a codebook.
#[derive(Serialize, Deserialize)]
struct Parts {
    dim: usize,
    scale: f64,
    centres: Vec<f32>,
}

impl TryFrom<Parts> for Codebook {
    type Error = Error;

    fn try_from(parts: Parts) -> Result<Self> {
        Self::from_parts(parts.centres, parts.dim, parts.scale)
    }
}

impl From<Codebook> for Parts {
    fn from(codebook: Codebook) -> Self {
        Self { dim: codebook.dim, scale: codebook.scale, centres: codebook.centres }
    }
}
