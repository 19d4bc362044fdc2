//! Principal components of blocks of inputs.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::data::check;
use crate::error::Result;
use crate::linalg;

/// A block of consecutive inputs, and how many of its principal components are kept.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FeatureBlock {
    /// Number of inputs, at least 1; they follow those of the previous blocks.
    pub inputs: usize,
    /// Maximum number of components.
    pub components: usize,
}

/// The principal components of some inputs, brought to a total variance of 1.
pub(crate) struct Pca {
    pub(crate) mean: Vec<f64>,
    /// d×K: orthogonal rows, each of the same length.
    pub(crate) matrix: Mat<f64>,
}

impl Pca {
    /// Of the rows of `x`, K×n, at most so many, the strongest first.
    pub(crate) fn of(x: MatRef<'_, f64>, components: usize) -> Result<Self> {
        check::matrix("x", x)?;
        let n = x.ncols() as f64;
        let mean: Vec<f64> = x.row_iter().map(|row| row.iter().sum::<f64>() / n).collect();
        let centred = Mat::from_fn(x.ncols(), x.nrows(), |i, k| x[(k, i)] - mean[k]);
        let eigen = linalg::eigen(&linalg::gram(centred.as_ref()))?;
        let strong = |&k: &usize| eigen.values[k] > 1e-12 * eigen.values[0];
        let kept: Vec<usize> = (0..components.min(x.nrows())).filter(strong).collect();
        let total: f64 = kept.iter().map(|&k| eigen.values[k] / n).sum();
        let scale = if total > 0.0 { total.sqrt().recip() } else { 0.0 };
        let matrix =
            Mat::from_fn(kept.len(), x.nrows(), |d, k| scale * eigen.vectors[(k, kept[d])]);
        Ok(Self { mean, matrix })
    }
}

/// The principal components of each block of the rows of `x`, K×n.
pub(crate) fn of_blocks(x: MatRef<'_, f64>, blocks: &[FeatureBlock]) -> Result<Vec<Pca>> {
    check::length("inputs of all blocks", x.nrows(), blocks.iter().map(|b| b.inputs).sum())?;
    let starts = blocks.iter().scan(0, |next, block| {
        let start = *next;
        *next += block.inputs;
        Some((start, block))
    });
    let starts: Vec<(usize, &FeatureBlock)> = starts.collect();
    let of_block = |&(start, block): &(usize, &FeatureBlock)| {
        Pca::of(x.subrows(start, block.inputs), block.components)
    };
    starts.par_iter().map(of_block).collect()
}
