//! The size of a problem, before there are data.

use faer::MatRef;

/// The size of a regression problem. `check(size)` of a fitter tells whether it can be fitted,
/// before samples are gathered.
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
