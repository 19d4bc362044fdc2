//! What is learnt for.

use phalanx::OrientationRule;
use phalanx_camera::Rig;
use phalanx_hand::HandShape;

/// The rig and the hand that are learnt for.
pub(crate) struct Ground {
    pub(crate) rig: Rig,
    pub(crate) hand: HandShape,
    pub(crate) rule: OrientationRule,
}
