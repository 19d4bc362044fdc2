//! What is fitted to which frames: the unknowns, and what is known of them beforehand.

use glam::DAffine3;
use phalanx_hand::{HandShape, Pose};

use crate::geometry::shape_parameters::Proportions;
use crate::observation::silhouette::Evidence;
use crate::priors::gaussian::Known;
use crate::priors::nuisance::{CameraDoubt, Correction, HandDoubt, Moves};
use crate::priors::pose::PosePrior;

/// One frame: what its cameras saw, and what is known of its pose.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) evidence: &'a [Evidence],
    pub(crate) prior: &'a PosePrior,
}

/// What is fitted besides the poses.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Freedom {
    pub(crate) hand: Option<HandDoubt>,
    pub(crate) cameras: Option<CameraDoubt>,
}

/// The unknowns of one frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Moment {
    pub(crate) pose: Pose,
    /// Of cameras that stand elsewhere in every frame; none of others.
    pub(crate) corrections: Vec<Correction>,
}

/// What all frames share.
#[derive(Debug, Clone)]
pub(crate) struct Shared {
    pub(crate) proportions: Proportions,
    /// Of cameras that stand where they stand; none of others.
    pub(crate) corrections: Vec<Correction>,
}

/// A fit of one hand to what cameras saw.
pub(crate) struct Problem<'a> {
    pub(crate) given: &'a HandShape,
    pub(crate) rest: &'a DAffine3,
    pub(crate) frames: Vec<Frame<'a>>,
    pub(crate) freedom: Freedom,
}

impl Problem<'_> {
    /// The unknowns of a frame before anything is known but a pose.
    pub(crate) fn moment(&self, frame: usize, pose: &Pose) -> Moment {
        let views = self.frames[frame].evidence.len();
        let each = self.freedom.cameras.is_some_and(|doubt| doubt.moves == Moves::EveryFrame);
        Moment { pose: *pose, corrections: vec![Correction::NONE; if each { views } else { 0 }] }
    }

    /// What all frames share before anything is known.
    pub(crate) fn shared(&self) -> Shared {
        let views = self.frames.first().map_or(0, |frame| frame.evidence.len());
        let all = self.freedom.cameras.is_some_and(|doubt| doubt.moves == Moves::Never);
        Shared {
            proportions: Proportions::of(self.given),
            corrections: vec![Correction::NONE; if all { views } else { 0 }],
        }
    }

    /// How the hand seems moved in a view.
    pub(crate) fn motion(&self, moment: &Moment, shared: &Shared, view: usize) -> DAffine3 {
        let correction = moment.corrections.get(view).or(shared.corrections.get(view));
        correction.map_or(DAffine3::IDENTITY, |own| own.motion(self.rest.translation))
    }

    /// What is known of the shared numbers: their energy, and for each its Hessian and gradient.
    pub(crate) fn shared_prior(&self, shared: &Shared) -> (f64, Vec<Known>) {
        let mut known = Vec::new();
        if let Some(HandDoubt { size, each }) = self.freedom.hand {
            for (k, &logarithm) in shared.proportions.logarithms.iter().enumerate() {
                known.push(Known::new(logarithm, if k == 0 { size } else { each }));
            }
        }
        known.extend(self.known_of(&shared.corrections));
        (known.iter().map(|known| known.energy).sum(), known)
    }

    pub(crate) fn known_of(&self, corrections: &[Correction]) -> Vec<Known> {
        let deviations = self.freedom.cameras.map_or([1.0; 2], |doubt| [doubt.turn, doubt.shift]);
        let of = move |correction: &Correction| {
            let parts = [correction.turn, correction.shift].map(|part| part.to_array());
            let known = move |k: usize| Known::new(parts[k / 3][k % 3], deviations[k / 3]);
            (0..Correction::NUMBERS).map(known)
        };
        corrections.iter().flat_map(of).collect()
    }
}
