//! What becomes of pictures.

use phalanx::ViewDoubt;

pub(super) enum Outcome {
    /// No hand was found in the picture of this camera.
    Refused(usize),
    Answered(Vec<ViewDoubt>),
}

impl Outcome {
    pub(super) fn is_doubted(&self) -> bool {
        match self {
            Self::Refused(_) => true,
            Self::Answered(doubts) => !doubts.is_empty(),
        }
    }
}
