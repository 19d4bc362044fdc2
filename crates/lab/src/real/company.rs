//! What takes are drawn with beside the hand.

use glam::{DAffine3, DVec3};
use phalanx_hand::{HandShape, Pose, PosedHand, Primitive, Sphere};

/// What is beside a hand.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Company {
    None,
    /// The person's other hand, which moves as it likes.
    OtherHand,
    /// A rod across the palm.
    Rod,
}

/// How far beside a hand the other one is, mm.
const BESIDE: f64 = 150.0;

/// Half a rod's length and its radius, mm, and how far its middle is from that of the knuckles.
const HALF_LENGTH: f64 = 70.0;
const RADIUS: f64 = 10.0;
const OFF_PALM: f64 = 25.0;

/// The other hand of a person, of whose one `rest` is the frame at rest.
pub(super) fn other_hand(hand: &HandShape, pose: &Pose, rest: &DAffine3) -> Vec<Primitive> {
    let other = HandShape { side: hand.side.other(), ..hand.clone() };
    other.pose(pose, &(*rest * DAffine3::from_translation(BESIDE * DVec3::X))).primitives
}

/// A rod across the palm of a hand whose back points towards `back`.
pub(super) fn rod(posed: &PosedHand, back: DVec3) -> Primitive {
    let [index, little] = [5, 17].map(|knuckle| posed.joints[knuckle]);
    let knuckles = index.midpoint(little);
    let along = (little - index).normalize();
    let normal = along.cross((knuckles - posed.joints[0]).normalize());
    let middle = knuckles - OFF_PALM * normal.dot(back).signum() * normal;
    let end = |way: f64| Sphere::new(middle + way * HALF_LENGTH * along, RADIUS);
    Primitive::RoundCone([end(-1.0), end(1.0)])
}
