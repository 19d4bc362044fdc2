//! The frame that came last, and what the next one tells of it.

use phalanx_hand::HandShape;
use phalanx_refine::PoseFit;

use super::motion::{Motion, Prediction};
use crate::fitting::found::Found;

/// The frame that came last.
#[derive(Debug, Clone)]
pub(super) struct Last {
    pub(super) time: f64,
    /// `None` where no view showed the hand.
    pub(super) found: Option<Found>,
    /// `None` as long as no view has shown a hand.
    pub(super) motion: Option<Motion>,
}

impl Last {
    /// The same in the light of the next one, which was predicted from it.
    pub(super) fn in_the_light(
        &self,
        prediction: Option<&Prediction>,
        next: &Self,
        hand: &HandShape,
    ) -> Self {
        let (Some(found), Some(motion)) = (&self.found, &self.motion) else {
            return self.clone();
        };
        let (Some(prediction), Some(later)) = (prediction, &next.motion) else {
            return self.clone();
        };
        // A hand that was looked for elsewhere tells nothing of the way to it.
        let is_followed = |found: &Found| found.rest == prediction.motion.rest;
        let smoothing = prediction.smoothing.as_ref();
        let Some(smoothing) = smoothing.filter(|_| next.found.as_ref().is_some_and(is_followed))
        else {
            return self.clone();
        };
        let pose = motion.smoothed(smoothing, &prediction.motion, later, hand);
        let refined = PoseFit { pose, ..found.refined.clone() };
        let found = Found { rest: motion.rest, refined, ..found.clone() };
        Self { found: Some(found), ..self.clone() }
    }
}
