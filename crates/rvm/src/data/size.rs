//! How large a problem is, before its data exist.

use faer::MatRef;

/// Counts of a regression problem. Fitters say by `check(size)` whether they would take it, so that
/// a caller need not gather samples first.
///
/// ```
/// use phalanx_rvm::{Error, KernelRidge, NystromRidge, ProblemSize};
///
/// let size = ProblemSize { samples: 14_000, inputs: 300, outputs: 28 };
/// let refused = KernelRidge::default().check(size);
/// assert!(matches!(refused, Err(Error::TooManyColumns { columns: 14_000, limit: 10_000 })));
/// assert!(NystromRidge::default().check(size).is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProblemSize {
    /// Number of samples I.
    pub samples: usize,
    /// Length K of an input.
    pub inputs: usize,
    /// Number m of targets.
    pub outputs: usize,
}

impl ProblemSize {
    /// The size of X (K×I) and Y (m×I).
    pub fn of(x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Self {
        Self { samples: x.ncols(), inputs: x.nrows(), outputs: y.nrows() }
    }
}
