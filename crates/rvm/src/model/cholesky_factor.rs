//! A triangular factor of a posterior covariance.

use faer::MatRef;

use crate::data::check::{self, numbers};
use crate::error::Result;
use crate::linalg::axpy;
use crate::model::scratch::Scratch;

/// A lower triangular matrix M over some of a model's columns.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CholeskyFactor {
    /// Columns of the model that M applies to.
    pub columns: Vec<usize>,
    /// M's columns from the diagonal down, one after the other: n(n+1)/2 numbers.
    pub packed: Vec<f64>,
}

impl CholeskyFactor {
    /// Packs a lower triangular matrix over `columns`.
    pub(crate) fn pack(columns: Vec<usize>, lower: MatRef<'_, f64>) -> Self {
        let n = columns.len();
        let packed = (0..n).flat_map(|j| (j..n).map(move |i| lower[(i, j)])).collect();
        Self { columns, packed }
    }

    /// M times the values that belong to this factor's columns.
    pub(crate) fn times(&self, values: &[f64]) -> Vec<f64> {
        let size = self.columns.len();
        let mut out = vec![0.0; size];
        let mut packed = self.packed.as_slice();
        for (j, &column) in self.columns.iter().enumerate() {
            let (below, rest) = packed.split_at(size - j);
            axpy(&mut out[j..], values[column], below);
            packed = rest;
        }
        out
    }

    /// ‖M φ‖² over this factor's columns.
    pub(crate) fn spread(&self, scratch: &mut Scratch) -> f64 {
        let Scratch { phi, chosen, spread, .. } = scratch;
        chosen.clear();
        chosen.extend(self.columns.iter().map(|&c| phi[c]));
        spread.clear();
        spread.resize(chosen.len(), 0.0);
        let mut packed = self.packed.as_slice();
        for (j, &value) in chosen.iter().enumerate() {
            let (column, rest) = packed.split_at(chosen.len() - j);
            axpy(&mut spread[j..], value, column);
            packed = rest;
        }
        spread.iter().map(|v| v * v).sum()
    }

    pub(crate) fn check(&self, p: usize) -> Result<()> {
        let n = self.columns.len();
        check::part("posterior", "repeats a column", n > p)?;
        check::part(
            "posterior",
            "names a column that is not there",
            self.columns.iter().any(|&c| c >= p),
        )?;
        numbers("posterior", &self.packed, n.checked_mul(n + 1).map(|twice| twice / 2))
    }
}
