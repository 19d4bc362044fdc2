//! The poses that may be behind an estimate.

use phalanx_hand::{Dof, Pose};

use crate::error::{Error, Result};
use crate::estimator::estimate::{Estimate, known};
use crate::estimator::model::Estimator;
use crate::estimator::placement::{placed, unplaced};

/// One pose among several that a hand may have.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypothesis {
    /// The pose, radians and millimetres.
    pub pose: Pose,
    /// How far poses that this one stands for stray from it, root mean square of each number, in
    /// its unit; `None` for a number that is not estimated.
    pub std: [Option<f64>; Dof::COUNT],
    /// The probability that the truth is nearer to this pose than to the other hypotheses.
    pub weight: f64,
}

impl Estimator {
    /// At most `most` poses that may be behind an estimate, the estimate's own first and the others
    /// by falling weight.
    ///
    /// # Errors
    /// An estimator that has not [learnt how it errs](Self::fit_error_model), or no or too many
    /// hypotheses asked for.
    pub fn hypotheses(&self, estimate: &Estimate, most: usize) -> Result<Vec<Hypothesis>> {
        let errors = self.expert(&estimate.observation)?.errors.ok_or(Error::NoErrorModel)?;
        let found =
            errors.residuals.hypotheses(&unplaced(&estimate.pose, self.framing()).0, most)?;
        let hypothesis = |found: &phalanx_rvm::Hypothesis| {
            let learnt = |dof: usize| estimate.std[dof].and(known(found.std[dof]));
            let mut hypothesis = Hypothesis {
                pose: Pose(std::array::from_fn(|dof| found.mean[dof])),
                std: std::array::from_fn(learnt),
                weight: found.weight,
            };
            for &dof in placed(self.framing()) {
                hypothesis.pose[dof] = estimate.pose[dof];
                hypothesis.std[dof.index()] = estimate.std[dof.index()];
            }
            hypothesis
        };
        Ok(found.iter().map(hypothesis).collect())
    }
}
