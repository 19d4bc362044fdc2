//! What a detector sees of a hand in a picture: points.

use glam::DVec2;

use crate::kinematics::JOINTS;

/// A joint of a hand as a detector sees it in a camera's picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmark {
    /// Where, px from the corner of the picture; pixel centres are at integer + 0.5.
    pub at: DVec2,
    /// How sure the detector is of it, 0 to 1; 1 of a detector that does not say.
    pub confidence: f64,
}

impl Landmark {
    /// A point that is as sure as any.
    pub fn sure(at: DVec2) -> Self {
        Self { at, confidence: 1.0 }
    }
}

/// The 21 points of one hand in one picture, in the order of [`PosedHand::joints`](crate::PosedHand::joints):
/// the wrist, then base to tip of thumb, index, middle, ring and little finger. `None` of those that were
/// not seen.
pub type Landmarks = [Option<Landmark>; JOINTS];
