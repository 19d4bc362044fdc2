//! Sums over streamed samples, from which regressions are fitted.

pub(crate) mod parts;
pub(crate) mod summed;

use faer::MatRef;
use rayon::prelude::*;

use crate::basis::spec::BasisSpec;
use crate::error::{Error, Result};
use crate::linalg;
use crate::stream::parts::{MOST_SAMPLES, SufficientStatisticsParts, UNITS};

/// Samples whose products are formed together.
const BLOCK: usize = 512;
/// Columns of the products that one task computes.
const WIDTH: usize = 96;
/// All that a regression on a [`BasisSpec`] needs to know of its samples: sums of products between
/// the p basis columns, the m standardised targets and the constant 1.
///
/// These are G = Σ φφᵀ, B = Σ φyᵀ, Σ yyᵀ, Σ φ, Σ y and the number of samples: (p + m + 1)²/2
/// numbers, whatever the number of samples.
///
/// **Order does not matter.** Each call of [`add`](Self::add) is cut into blocks of 512 samples.
/// The products of a block are rounded to multiples of 2⁻⁶⁴ (most already are: every double above
/// 2⁻¹¹ in magnitude is one) and added as integers, which is associative. The same calls therefore
/// give the same bits in any order, in any number of [merged](Self::merge) parts and with any
/// number of threads. Only between different kinds of CPU can the last bit of a block's products
/// differ.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "SufficientStatisticsParts", into = "SufficientStatisticsParts")
)]
pub struct SufficientStatistics {
    parts: SufficientStatisticsParts,
}

impl SufficientStatistics {
    /// Sums over no samples. Takes 16 bytes for each of (p + m + 1)(p + m + 2)/2 numbers.
    pub fn new(columns: &BasisSpec) -> Self {
        let (size, outputs) = (columns.size(), columns.outputs());
        let all = size + outputs + 1;
        let packed = vec![0; all * (all + 1) / 2];
        Self {
            parts: SufficientStatisticsParts {
                columns: columns.fingerprint(),
                size,
                outputs,
                packed,
            },
        }
    }

    /// Adds samples: inputs K×n and targets m×n. On an error the sums are unchanged.
    ///
    /// To get the same bits in another run, add the same samples in each call. Working memory is
    /// 512 × (p + m + 1) numbers.
    pub fn add(
        &mut self,
        columns: &BasisSpec,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
    ) -> Result<()> {
        self.check_columns(columns)?;
        columns.check_samples(x, y)?;
        self.check_room(x.ncols())?;
        for start in (0..x.ncols()).step_by(BLOCK) {
            let width = BLOCK.min(x.ncols() - start);
            let block = columns.evaluate(x.subcols(start, width), y.subcols(start, width));
            self.add_products(block.as_ref());
        }
        Ok(())
    }

    /// Adds the sums over other samples. On an error the sums are unchanged.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        let SufficientStatisticsParts { columns, size, outputs, .. } = other.parts;
        self.check_same(columns, size, outputs)?;
        self.check_room(other.samples())?;
        for (sum, other) in self.parts.packed.iter_mut().zip(&other.parts.packed) {
            *sum += other;
        }
        Ok(())
    }

    /// Puts sums together from their parts, checked against each other.
    pub fn from_parts(parts: SufficientStatisticsParts) -> Result<Self> {
        parts.check()?;
        Ok(Self { parts })
    }

    /// The sums' parts.
    pub fn into_parts(self) -> SufficientStatisticsParts {
        self.parts
    }

    /// The sums' parts, borrowed.
    pub fn parts(&self) -> &SufficientStatisticsParts {
        &self.parts
    }

    /// Number of samples added.
    pub fn samples(&self) -> usize {
        self.parts.samples()
    }

    /// Adds the products of each two columns of a block, from the diagonal down.
    fn add_products(&mut self, block: MatRef<'_, f64>) {
        let all = block.ncols();
        column_chunks(&mut self.parts.packed, all).into_par_iter().for_each(|(start, mut sums)| {
            let width = WIDTH.min(all - start);
            let below = block.subcols(start, all - start).transpose();
            let products = linalg::product(below, block.subcols(start, width));
            for j in 0..width {
                let (column, rest) = sums.split_at_mut(all - start - j);
                for (sum, product) in column.iter_mut().zip(&products.col_as_slice(j)[j..]) {
                    *sum += (product * UNITS) as i128;
                }
                sums = rest;
            }
        });
    }

    /// Refuses columns that are not the ones summed.
    fn check_columns(&self, columns: &BasisSpec) -> Result<()> {
        self.check_same(columns.fingerprint(), columns.size(), columns.outputs())
    }

    /// The counts matter too: parts from outside may have any fingerprint.
    fn check_same(&self, columns: u64, size: usize, outputs: usize) -> Result<()> {
        let SufficientStatisticsParts { columns: sums, size: summed, outputs: targets, .. } =
            self.parts;
        if (sums, summed, targets) == (columns, size, outputs) {
            return Ok(());
        }
        Err(Error::OtherColumns { sums, columns })
    }

    fn check_room(&self, more: usize) -> Result<()> {
        room(self.samples().saturating_add(more))
    }
}

impl TryFrom<SufficientStatisticsParts> for SufficientStatistics {
    type Error = Error;

    fn try_from(parts: SufficientStatisticsParts) -> Result<Self> {
        Self::from_parts(parts)
    }
}

impl From<SufficientStatistics> for SufficientStatisticsParts {
    fn from(sums: SufficientStatistics) -> Self {
        sums.into_parts()
    }
}

/// Refuses more samples than one sum takes.
pub(crate) fn room(samples: usize) -> Result<()> {
    if samples <= MOST_SAMPLES {
        return Ok(());
    }
    Err(Error::TooManySamples { samples, limit: MOST_SAMPLES })
}

/// Cuts a packed lower triangle over `all` columns into chunks of whole columns, each with the
/// index of its first.
fn column_chunks(mut packed: &mut [i128], all: usize) -> Vec<(usize, &mut [i128])> {
    let mut chunks = Vec::with_capacity(all.div_ceil(WIDTH));
    for start in (0..all).step_by(WIDTH) {
        let end = all.min(start + WIDTH);
        let (chunk, rest) = packed.split_at_mut((start..end).map(|j| all - j).sum());
        chunks.push((start, chunk));
        packed = rest;
    }
    chunks
}
