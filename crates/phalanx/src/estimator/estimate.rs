//! What an estimator says of a hand.

use glam::DVec3;
use phalanx_hand::{Dof, JOINTS, Pose};

use crate::checking::doubt::ViewDoubt;
use crate::estimator::observation::Observation;

/// What is known of a hand after looking at it.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// The pose, radians and millimetres.
    pub pose: Pose,
    /// Predictive standard deviation of each number of the pose, in its unit; `None` for a number that
    /// is not estimated, because it did not vary in what was learnt from.
    pub std: [Option<f64>; Dof::COUNT],
    /// Within how many standard deviations each number is in 95 of 100 cases: 1.96, unless
    /// [refined errors](crate::RefinedErrors) are known to be otherwise.
    pub tails: [f64; Dof::COUNT],
    /// The 21 joints in the world, mm.
    pub joints: [DVec3; JOINTS],
    /// What was seen.
    pub observation: Observation,
    /// How well the hand, drawn again, and what each view of the observation shows agree: intersection over
    /// union, 0 to 1. None where silhouettes were given without the windows that they are seen in.
    pub overlaps: Vec<f64>,
    /// Why the answer may be wrong. An estimator that has not
    /// [learnt how it errs](crate::Estimator::fit_error_model) does not know which overlaps are usual.
    pub doubts: Vec<ViewDoubt>,
}

/// Within how many standard deviations 95 of 100 values of a normal distribution are.
pub(crate) const NORMAL_TAIL: f64 = 1.96;

impl Estimate {
    /// Half of the interval about a number of the pose that holds the truth in 95 of 100 cases, in its
    /// unit; `None` for a number that is not estimated.
    pub fn interval(&self, dof: Dof) -> Option<f64> {
        Some(self.tails[dof.index()] * self.std[dof.index()]?)
    }
}

/// A regressor's standard deviation, if it knows one: it is infinite, or 0 in the models of old, where
/// the training poses did not vary.
pub(crate) fn known(std: f64) -> Option<f64> {
    (std > 0.0 && std.is_finite()).then_some(std)
}
