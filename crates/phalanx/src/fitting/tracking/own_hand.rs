//! The hand's proportions, learnt on the way from frames that differ, and then kept.

use glam::DAffine3;
use phalanx_hand::{Dof, HandShape};

use crate::error::Result;
use crate::fitting::found::Found;
use crate::fitting::frame_fit::FrameFitter;
use crate::fitting::proportions::{self, HandEvidence, KnownHand};

/// Frames that a hand is learnt from and tested on.
const FRAMES: usize = 32;

/// A posture in which some joint is bent otherwise than in the last one by as much as this tells something
/// new, radians: a tenth of a joint's range.
const NEW: f64 = 0.15;

/// Frames that the hand is going to be learnt from.
#[derive(Debug, Clone)]
pub(super) struct OwnHand {
    mean: HandShape,
    /// Whether the mean hand is of about that person's size.
    is_sized: bool,
    /// Frames that might have told the size.
    looked_at: usize,
    kept: Vec<Option<Found>>,
}

impl OwnHand {
    pub(super) fn new(mean: HandShape) -> Self {
        Self { mean, is_sized: false, looked_at: 0, kept: Vec::new() }
    }

    /// Of somebody whose hand is about as large as this mean hand.
    pub(super) fn sized(mean: HandShape) -> Self {
        Self { is_sized: true, ..Self::new(mean) }
    }

    /// Whether the next frame may still tell how large the hand is: one that no picture shows whole for long keeps the size
    /// that it was thought to have, for looking takes time.
    pub(super) fn awaits_size(&self) -> bool {
        !self.is_sized && self.looked_at < FRAMES
    }

    /// Counts a frame that might have told the size.
    pub(super) fn look(&mut self) {
        self.looked_at += 1;
    }

    /// Keeps a frame that was fitted well, if it shows something new; whether there are enough now.
    pub(super) fn keep(&mut self, found: &Found) -> bool {
        let is_new = self.kept.last().and_then(Option::as_ref).is_none_or(|last| {
            let joints = Dof::ALL.into_iter().filter(|dof| dof.index() < Dof::ThetaX.index());
            let (last, own) = (&last.refined.pose, &found.refined.pose);
            joints.into_iter().any(|dof| (last[dof] - own[dof]).abs() > NEW)
        });
        if is_new {
            self.kept.push(Some(found.clone()));
        }
        self.kept.len() >= FRAMES
    }

    /// The frames that were kept.
    pub(super) fn kept(&self) -> &[Option<Found>] {
        &self.kept
    }

    /// The hand, if one that is learnt from half of the frames fits the others better than the mean hand.
    pub(super) fn learn(
        &self,
        fitter: &FrameFitter<'_>,
        rest: &DAffine3,
        border: HandEvidence,
    ) -> Result<Option<KnownHand>> {
        proportions::learn(&self.mean, fitter, &self.kept, rest, border)
    }
}
