//! What a take tells besides poses.

use phalanx_hand::HandShape;
use serde::{Deserialize, Serialize};

use super::mistake::Mistake;
use super::proportions::KnownHand;
use super::weights::ViewWeights;

/// What a take tells of its hand and its cameras, besides poses.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Known {
    pub(super) hand: KnownHand,
    /// How much what each view shows counts.
    pub(super) weights: ViewWeights,
    /// What seems mistaken about hand and cameras.
    pub(super) mistake: Option<Mistake>,
}

impl Known {
    /// Of a hand and of views of which nothing is known.
    pub(super) fn nothing(hand: &HandShape, views: usize) -> Self {
        let weights = ViewWeights::unknown(views);
        Self { hand: KnownHand::anyone(hand), weights, mistake: None }
    }
}
