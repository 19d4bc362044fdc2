//! The hand and the cameras that a fit ended with.

use glam::DAffine3;
use phalanx_hand::HandShape;

use crate::solver::levenberg_marquardt::State;
use crate::solver::problem::Problem;

/// The hand's shape and the cameras' places, fitted together with a pose.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedNuisance {
    /// The hand.
    pub hand: HandShape,
    /// How the hand seems moved, in the world, to each camera with a silhouette.
    pub motions: Vec<DAffine3>,
}

impl FittedNuisance {
    /// Of the first frame of a state.
    pub(crate) fn of(problem: &Problem<'_>, state: &State) -> Self {
        let views = 0..problem.frames[0].evidence.silhouettes.len();
        let motion = |view| problem.motion(&state.frames[0], &state.shared, view);
        Self { hand: state.shared.shape.hand(problem.given), motions: views.map(motion).collect() }
    }
}
