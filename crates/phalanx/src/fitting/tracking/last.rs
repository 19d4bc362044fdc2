//! The frame that came last, and what the next one tells of it.

use phalanx_hand::HandShape;
use phalanx_refine::{PoseFit, SilhouetteObservation};

use super::motion::{Motion, Prediction};
use crate::fitting::found::Found;

/// The frame that came last.
#[derive(Debug, Clone)]
pub(super) struct Last {
    pub(super) time: f64,
    /// `None` where no view showed the hand.
    pub(super) found: Option<Found>,
    /// What each view shows of the hand that was found.
    pub(super) silhouettes: Vec<Option<SilhouetteObservation>>,
    /// `None` as long as no view has shown a hand.
    pub(super) motion: Option<Motion>,
}

impl Last {
    /// One that shows no hand.
    pub(super) fn unseen(time: f64, motion: Option<Motion>) -> Self {
        Self { time, found: None, silhouettes: Vec::new(), motion }
    }

    /// The same in the light of the next one, which was predicted from it.
    pub(super) fn in_the_light(
        self,
        prediction: Option<&Prediction>,
        next: &Self,
        hand: &HandShape,
    ) -> Self {
        let (Some(found), Some(motion)) = (&self.found, &self.motion) else {
            return self;
        };
        let (Some(prediction), Some(later)) = (prediction, &next.motion) else {
            return self;
        };
        // A hand that was looked for elsewhere tells nothing of the way to it.
        let is_followed = |found: &Found| found.rest == prediction.motion.rest;
        let smoothing = prediction.smoothing.as_ref();
        let Some(smoothing) = smoothing.filter(|_| next.found.as_ref().is_some_and(is_followed))
        else {
            return self;
        };
        let pose = motion.smoothed(smoothing, &prediction.motion, later, hand);
        let refined = PoseFit { pose, ..found.refined.clone() };
        let found = Found { rest: motion.rest, refined, ..found.clone() };
        Self { found: Some(found), ..self }
    }
}
