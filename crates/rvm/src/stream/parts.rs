//! Sums in plain numbers, and the check that they can be sums of samples.

use crate::basis::spec::FURTHEST;
use crate::error::{Error, Result};

/// Most samples in one sum. With no standardised number above 2¹⁶ no sum exceeds 2⁶², whatever
/// the samples, so that nothing here can overflow.
pub(super) const MOST_SAMPLES: usize = 1 << 30;
/// 2⁶⁴: sums are kept in units of its inverse.
pub(super) const UNITS: f64 = 18_446_744_073_709_551_616.0;
/// One, in the sums' units.
const ONE: i128 = 1 << 64;

/// Everything that [`SufficientStatistics`](crate::SufficientStatistics) are made of.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SufficientStatisticsParts {
    /// Fingerprint of the columns.
    pub columns: u64,
    /// Number of basis columns p.
    pub size: usize,
    /// Number of targets m.
    pub outputs: usize,
    /// Sums of products of each two among the p columns, the m targets and 1, in this order, in
    /// units of 2⁻⁶⁴: the columns of a symmetric matrix from the diagonal down, one after the
    /// other. The last is the number of samples.
    pub packed: Vec<i128>,
}

impl SufficientStatisticsParts {
    /// Number of samples.
    pub(super) fn samples(&self) -> usize {
        self.packed.last().map_or(0, |&units| (units / ONE) as usize)
    }

    pub(super) fn check(&self) -> Result<()> {
        let all = self.size.checked_add(self.outputs).and_then(|sum| sum.checked_add(1));
        let length =
            all.and_then(|all| all.checked_mul(all.checked_add(1)?)).map(|twice| twice / 2);
        fault("outputs", "must be at least 1", self.outputs == 0)?;
        fault("packed", "has the wrong length", Some(self.packed.len()) != length)?;
        let count = self.packed.last().copied().unwrap_or(0);
        let range = 0..=ONE * MOST_SAMPLES as i128;
        let whole = range.contains(&count) && count % ONE == 0;
        fault("packed", "does not end in a number of samples", !whole)?;
        // Twice what exact arithmetic could give.
        let most = 2 * count.unsigned_abs() * (FURTHEST * FURTHEST) as u128;
        let beyond = self.packed.iter().any(|sum| sum.unsigned_abs() > most);
        fault("packed", "holds a number that so few samples cannot sum to", beyond)
    }
}

fn fault(field: &'static str, problem: &'static str, present: bool) -> Result<()> {
    if present { Err(Error::SufficientStatisticsParts { field, problem }) } else { Ok(()) }
}
