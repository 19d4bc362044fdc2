//! Unsigned angles between the bones of 21 joints, and what they say of the fingers.

use glam::DVec3;
use phalanx_hand::JOINTS;

/// How many angles there are.
pub const COUNT: usize = 15;

/// One value for each angle.
pub type BoneAngles<T> = [T; COUNT];

const DIGITS: [&str; 5] = ["thumb", "index", "middle", "ring", "pinky"];
const PLACES: [[&str; 3]; 2] = [["CMC", "MCP", "IP"], ["MCP", "PIP", "DIP"]];

/// The bend below which a finger, and below which a thumb is extended, degrees.
const EXTENDED_DEG: f64 = 72.5;
const THUMB_EXTENDED_DEG: f64 = 50.0;

/// Whether a finger is extended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FingerState {
    /// Bent by less than the limit.
    Extended,
    /// Bent by more.
    Folded,
}

/// The name of the k-th angle: digit and joint.
pub fn name(k: usize) -> String {
    format!("{}_{}", DIGITS[k / 3], PLACES[usize::from(k >= 3)][k % 3])
}

/// The unsigned angles between consecutive bones, degrees: wrist to base, base to middle and so on, three
/// for each digit.
pub fn of_joints(joints: &[DVec3; JOINTS]) -> BoneAngles<f64> {
    std::array::from_fn(|k| {
        let (digit, place) = (k / 3, k % 3);
        let at = 1 + 4 * digit + place;
        let before = if place == 0 { 0 } else { at - 1 };
        let bones = [joints[at] - joints[before], joints[at + 1] - joints[at]];
        bones[0].angle_between(bones[1]).to_degrees()
    })
}

/// The states of the five digits: how far the last two angles bend in all.
pub fn states(angles: &BoneAngles<f64>) -> [FingerState; 5] {
    std::array::from_fn(|digit| {
        let limit = if digit == 0 { THUMB_EXTENDED_DEG } else { EXTENDED_DEG };
        if angles[3 * digit + 1] + angles[3 * digit + 2] < limit {
            FingerState::Extended
        } else {
            FingerState::Folded
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hand whose digits all bend by so many degrees at each of their joints.
    fn bent(degrees: f64) -> [DVec3; JOINTS] {
        let mut joints = [DVec3::ZERO; JOINTS];
        for digit in 0..5 {
            let mut at = DVec3::ZERO;
            for place in 0..4 {
                let turn = (f64::from(place) * degrees).to_radians();
                at += 10.0 * DVec3::new(turn.cos(), turn.sin(), 0.0);
                joints[1 + 4 * digit + place as usize] = at;
            }
        }
        joints
    }

    #[test]
    fn angles_are_those_that_bones_were_bent_by() {
        for angle in of_joints(&bent(30.0)) {
            assert!((angle - 30.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_thumb_folds_earlier_than_fingers() {
        use FingerState::{Extended, Folded};
        let of = |degrees| states(&of_joints(&bent(degrees)));
        assert_eq!(of(24.0), [Extended; 5]);
        assert_eq!(of(26.0), [Folded, Extended, Extended, Extended, Extended]);
        assert_eq!(of(37.0), [Folded; 5]);
    }

    #[test]
    fn angles_have_the_names_of_the_reference() {
        assert_eq!([name(0), name(2), name(5)], ["thumb_CMC", "thumb_IP", "index_DIP"]);
        assert_eq!(name(14), "pinky_DIP");
    }
}
