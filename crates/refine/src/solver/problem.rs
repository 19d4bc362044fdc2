//! What is fitted to which frames: the unknowns, and what is known of them beforehand.

use glam::DAffine3;
use phalanx_hand::{HandShape, Pose};

use crate::geometry::shape_parameters::ShapeParameters;
use crate::observation::evidence::Evidence;
use crate::priors::gaussian::GaussianPenalty;
use crate::priors::nuisance::{CameraMotion, ExtrinsicsCorrection, ExtrinsicsPrior, ShapePrior};
use crate::priors::pose::PosePrior;

/// One frame: what its cameras saw, and what is known of its pose.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) evidence: Evidence<'a>,
    pub(crate) prior: &'a PosePrior,
}

/// What is fitted besides the poses.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct FreeParameters {
    pub(crate) hand: Option<ShapePrior>,
    pub(crate) cameras: Option<ExtrinsicsPrior>,
}

/// The unknowns of one frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrameParameters {
    pub(crate) pose: Pose,
    /// Of cameras that stand elsewhere in every frame; none of others.
    pub(crate) corrections: Vec<ExtrinsicsCorrection>,
}

/// What all frames share.
#[derive(Debug, Clone)]
pub(crate) struct SharedParameters {
    pub(crate) shape: ShapeParameters,
    /// Of cameras that stand where they stand; none of others.
    pub(crate) corrections: Vec<ExtrinsicsCorrection>,
}

/// A fit of one hand to what cameras saw.
pub(crate) struct Problem<'a> {
    pub(crate) given: &'a HandShape,
    pub(crate) rest: &'a DAffine3,
    pub(crate) frames: Vec<Frame<'a>>,
    pub(crate) freedom: FreeParameters,
}

impl Problem<'_> {
    /// The unknowns of a frame before anything is known but a pose.
    pub(crate) fn frame_parameters(&self, frame: usize, pose: &Pose) -> FrameParameters {
        let views = self.frames[frame].evidence.views();
        let each =
            self.freedom.cameras.is_some_and(|nuisance| nuisance.motion == CameraMotion::PerFrame);
        FrameParameters {
            pose: *pose,
            corrections: vec![ExtrinsicsCorrection::NONE; if each { views } else { 0 }],
        }
    }

    /// What all frames share before anything is known.
    pub(crate) fn shared(&self) -> SharedParameters {
        let views = self.frames.first().map_or(0, |frame| frame.evidence.views());
        let all =
            self.freedom.cameras.is_some_and(|nuisance| nuisance.motion == CameraMotion::Static);
        SharedParameters {
            shape: ShapeParameters::of(self.given),
            corrections: vec![ExtrinsicsCorrection::NONE; if all { views } else { 0 }],
        }
    }

    /// How the hand seems moved in a view.
    pub(crate) fn motion(
        &self,
        parameters: &FrameParameters,
        shared: &SharedParameters,
        view: usize,
    ) -> DAffine3 {
        let correction = parameters.corrections.get(view).or(shared.corrections.get(view));
        correction.map_or(DAffine3::IDENTITY, |own| own.motion(self.rest.translation))
    }

    /// What is known of the shared numbers: their energy, and for each its Hessian and gradient.
    pub(crate) fn shared_prior(&self, shared: &SharedParameters) -> (f64, Vec<GaussianPenalty>) {
        let mut known = Vec::new();
        if let Some(prior) = self.freedom.hand {
            let deviations = prior.deviations(self.given);
            let numbers = shared.shape.logarithms.iter().zip(deviations);
            known.extend(numbers.map(|(&number, std)| GaussianPenalty::new(number, std)));
        }
        known.extend(self.penalties_of(&shared.corrections));
        (known.iter().map(|known| known.energy).sum(), known)
    }

    pub(crate) fn penalties_of(
        &self,
        corrections: &[ExtrinsicsCorrection],
    ) -> Vec<GaussianPenalty> {
        let deviations =
            self.freedom.cameras.map_or([1.0; 2], |nuisance| [nuisance.turn, nuisance.shift]);
        let of = move |correction: &ExtrinsicsCorrection| {
            let parts = [correction.turn, correction.shift].map(|part| part.to_array());
            let known =
                move |k: usize| GaussianPenalty::new(parts[k / 3][k % 3], deviations[k / 3]);
            (0..ExtrinsicsCorrection::NUMBERS).map(known)
        };
        corrections.iter().flat_map(of).collect()
    }
}
