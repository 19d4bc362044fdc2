//! How an estimator errs.

use phalanx_rvm::ResidualKde;

use crate::checking::usual::UsualExplanation;
use crate::estimator::placement::PlacementErrors;

/// How an estimator errs.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorModel {
    /// The errors of what regression tells.
    pub residuals: ResidualKde,
    /// How well its answers explain what was seen.
    pub usual: UsualExplanation,
    /// The errors of what windows tell, if the estimator looks through windows.
    pub placement: Option<PlacementErrors>,
}
