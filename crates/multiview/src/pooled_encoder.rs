//! Low-level fusion: all views' shape contexts in one histogram.

use phalanx_codebook::{Codebook, SoftAssignment};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::scratch::Scratch;

/// One codebook for the shape contexts of all views, which vote into one histogram (§ 2 of the
/// paper: "the low level approach"). Which view a context came from is lost.
///
/// Any number of views can be described: a missing view is one entry fewer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct PooledEncoder {
    codebook: Codebook,
    assignment: SoftAssignment,
}

/// The stored form of a [`PooledEncoder`].
#[derive(Serialize, Deserialize)]
struct Parts {
    codebook: Codebook,
    assignment: SoftAssignment,
}

impl TryFrom<Parts> for PooledEncoder {
    type Error = Error;

    fn try_from(parts: Parts) -> Result<Self> {
        Self::from_parts(parts.codebook, parts.assignment)
    }
}

impl From<PooledEncoder> for Parts {
    fn from(pooled: PooledEncoder) -> Self {
        Self { codebook: pooled.codebook, assignment: pooled.assignment }
    }
}

impl PooledEncoder {
    /// A codebook and how shape contexts vote into it.
    ///
    /// # Errors
    /// A codebook with fewer centres than each shape context votes into.
    ///
    /// ```
    /// use phalanx_codebook::{Codebook, SoftAssignment};
    /// use phalanx_multiview::{PooledEncoder, Scratch};
    ///
    /// let codebook = Codebook::from_parts(vec![1.0, 0.0, 0.0, 1.0], 2, 0.1)?;
    /// let pooled = PooledEncoder::from_parts(codebook, SoftAssignment::HARD)?;
    /// let mut x = [0.0; 2];
    /// pooled.describe(&[[0.9, 0.1], [0.2, 0.8]], &mut Scratch::default(), &mut x)?;
    /// assert_eq!(x, [0.5, 0.5]);
    /// pooled.describe(&[[0.9, 0.1]], &mut Scratch::default(), &mut x)?; // a view is missing
    /// assert_eq!(x, [1.0, 0.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_parts(codebook: Codebook, assignment: SoftAssignment) -> Result<Self> {
        let (neighbours, centres) = (assignment.neighbours, codebook.len());
        if !(1..=centres).contains(&neighbours) {
            return Err(Error::Pooled(phalanx_codebook::Error::Neighbours { neighbours, centres }));
        }
        Ok(Self { codebook, assignment })
    }

    /// The codebook.
    pub fn codebook(&self) -> &Codebook {
        &self.codebook
    }

    /// How shape contexts vote.
    pub fn assignment(&self) -> SoftAssignment {
        self.assignment
    }

    /// The length of the histogram.
    pub fn dim(&self) -> usize {
        self.codebook.len()
    }

    /// The histogram of one sample's views, written to `x`: non-negative, with a sum of 1.
    /// `contexts[v]` holds the shape contexts of view v one after the other; their order does not
    /// matter, and every context counts alike.
    ///
    /// # Errors
    /// No view, an `x` of another length, or what the codebook says of the contexts.
    pub fn describe<C: AsRef<[f32]>>(
        &self,
        contexts: &[C],
        scratch: &mut Scratch,
        x: &mut [f64],
    ) -> Result<()> {
        if contexts.is_empty() {
            return Err(Error::NoViews);
        }
        if x.len() != self.dim() {
            return Err(Error::OutputLength { expected: self.dim(), found: x.len() });
        }
        let Scratch { coding, pool } = scratch;
        pool.clear();
        for view in contexts {
            pool.extend_from_slice(view.as_ref());
        }
        self.codebook.soft_assign(pool, self.assignment, coding, x).map_err(Error::Pooled)
    }
}
