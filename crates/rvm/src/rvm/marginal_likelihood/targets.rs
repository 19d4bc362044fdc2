//! Targets as the evidence sees them.

use faer::{Mat, MatRef};

/// Standardised targets, none of them constant, seen through the normal equations.
#[derive(Clone, Copy)]
pub(crate) struct Targets<'a> {
    /// G = ΦᵀΦ, p×p.
    pub(crate) gram: &'a Mat<f64>,
    /// ΦᵀY, p×m.
    pub(crate) correlations: MatRef<'a, f64>,
    /// ‖yⱼ‖² of each of the m targets.
    pub(crate) energies: &'a [f64],
    /// Samples less one for the bias.
    pub(crate) freedom: f64,
}
