//! Gaussians on the samples that are their centres.

use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

use crate::basis::kernel;
use crate::linalg;

/// Columns that one task computes.
const BLOCK: usize = 96;

/// Gaussians of one width.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Gaussians {
    /// |β|.
    pub(super) beta: f64,
    /// Index of each centre in the training set.
    pub(super) samples: Vec<usize>,
    /// Standardised centres, features×p.
    pub(super) centres: Mat<f64>,
}

impl Gaussians {
    /// Gaussian kernel between all pairs of centres, p×p.
    pub(super) fn between_centres(&self) -> Mat<f64> {
        kernel::gaussian(self.centres.as_ref(), self.beta)
    }

    /// exp(−β‖z − c‖²) less the origins, for each sample of `z` (features×n) and centre c, into
    /// `out`, n×p.
    pub(super) fn evaluate(&self, z: MatRef<'_, f64>, origins: &[f64], out: MatMut<'_, f64>) {
        let norms: Vec<f64> = z.col_iter().map(|sample| sample.squared_norm_l2()).collect();
        out.par_col_chunks_mut(BLOCK).enumerate().for_each(|(block, mut out)| {
            let start = block * BLOCK;
            let centres = self.centres.subcols(start, out.ncols());
            let inner = linalg::product(z.transpose(), centres);
            for (k, column) in out.as_mut().col_iter_mut().enumerate() {
                let (norm, origin) = (centres.col(k).squared_norm_l2(), origins[start + k]);
                let from = inner.col_as_slice(k).iter().zip(&norms);
                for (value, (inner, sample)) in column.iter_mut().zip(from) {
                    let squared = sample + norm - 2.0 * inner;
                    *value = (-self.beta * squared.max(0.0)).exp() - origin;
                }
            }
        });
    }
}
