//! How a hand is tracked.

use phalanx_hand::HandShape;

use super::delay::Delay;
use crate::fitting::take::Proportions;

/// How a hand is tracked.
#[derive(Debug, Clone, PartialEq)]
pub struct TrackSettings {
    /// The hand, which may be a mean one, and its side.
    pub hand: HandShape,
    /// Whether the hand is that person's, or its proportions are learnt on the way and then kept.
    pub proportions: Proportions,
    /// How long answers may wait.
    pub delay: Delay,
}

impl Default for TrackSettings {
    /// A right hand like any other, a frame late.
    fn default() -> Self {
        let (hand, proportions) = (HandShape::adult(), Proportions::FromTake);
        Self { hand, proportions, delay: Delay::default() }
    }
}
