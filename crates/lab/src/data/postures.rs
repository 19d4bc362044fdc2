//! Postures of the hand: some with names, and any by which digits are stretched out.

use phalanx::ItemRng;
use phalanx_hand::{Digit, Pose};

/// A digit's abduction and its three flexions from the base outwards, degrees.
type Joints = [f64; 4];

/// A posture of the digits.
pub(crate) struct Posture {
    pub(crate) name: &'static str,
    /// Thumb first.
    digits: [Joints; 5],
}

const BENT: Joints = [0.0, 72.0, 95.0, 62.0];
const HALF_BENT: Joints = [0.0, 38.0, 48.0, 32.0];
const THUMB_OUT: Joints = [15.0, -8.0, -2.0, -2.0];
const THUMB_ALONGSIDE: Joints = [-12.0, 22.0, 5.0, 0.0];
const THUMB_IN: Joints = [-5.0, 38.0, 48.0, 45.0];

/// A stretched finger, so many degrees away from the middle finger.
const fn stretched(abduction: f64) -> Joints {
    [abduction, 2.0, 4.0, 3.0]
}

/// Twelve postures whose silhouettes from above differ.
#[rustfmt::skip]
pub(crate) const NAMED: [Posture; 12] = [
    Posture { name: "fist", digits: [THUMB_IN, BENT, BENT, BENT, BENT] },
    Posture { name: "flat", digits: [
        THUMB_ALONGSIDE, stretched(-4.0), stretched(0.0), stretched(-4.0), stretched(-9.0),
    ] },
    Posture { name: "spread", digits: [
        THUMB_OUT, stretched(14.0), stretched(2.0), stretched(9.0), stretched(18.0),
    ] },
    Posture { name: "point", digits: [THUMB_IN, stretched(0.0), BENT, BENT, BENT] },
    Posture { name: "victory", digits: [THUMB_IN, stretched(12.0), stretched(-6.0), BENT, BENT] },
    Posture { name: "three", digits: [THUMB_OUT, stretched(10.0), stretched(-4.0), BENT, BENT] },
    Posture { name: "four", digits: [
        THUMB_IN, stretched(8.0), stretched(0.0), stretched(6.0), stretched(10.0),
    ] },
    Posture { name: "thumb", digits: [THUMB_OUT, BENT, BENT, BENT, BENT] },
    Posture { name: "grasp", digits: [[20.0, 10.0, 15.0, 15.0], HALF_BENT, HALF_BENT, HALF_BENT, HALF_BENT] },
    Posture { name: "ring", digits: [
        [10.0, 24.0, 22.0, 30.0], [0.0, 46.0, 58.0, 38.0], stretched(0.0), stretched(6.0), stretched(12.0),
    ] },
    Posture { name: "horns", digits: [THUMB_IN, stretched(4.0), BENT, BENT, stretched(8.0)] },
    Posture { name: "thumb and little", digits: [THUMB_OUT, BENT, BENT, BENT, stretched(12.0)] },
];

impl Posture {
    /// The posture, palm down.
    pub(crate) fn pose(&self) -> Pose {
        posed(self.digits)
    }

    /// The posture as it happens to be held: every joint off by up to so many degrees.
    pub(crate) fn held(&self, by_deg: f64, random: &mut ItemRng) -> Pose {
        posed(self.digits.map(|joints| joints.map(|j| j + random.between(-by_deg, by_deg))))
    }
}

/// Which digits are stretched out, thumb first.
pub(crate) type Out = [bool; 5];

/// All 32 ways to stretch digits out.
pub(crate) fn all_ways_out() -> impl Iterator<Item = Out> {
    (0..32_u32).map(|bits| std::array::from_fn(|digit| bits >> digit & 1 == 1))
}

/// A random posture with these digits out and the others bent.
pub(crate) fn with_digits_out(out: Out, random: &mut ItemRng) -> Pose {
    posed(std::array::from_fn(|digit| {
        let mut within = |[low, high]: [f64; 2]| random.between(low, high);
        match (digit, out[digit]) {
            (0, true) => [[0.0, 35.0], [-15.0, 10.0], [-10.0, 15.0], [-15.0, 20.0]].map(within),
            (0, false) => [[-20.0, 15.0], [20.0, 45.0], [20.0, 60.0], [15.0, 80.0]].map(within),
            (_, true) => [[-8.0, 18.0], [-10.0, 20.0], [0.0, 18.0], [0.0, 12.0]].map(within),
            (_, false) => {
                let pip = within([65.0, 108.0]);
                [within([-5.0, 5.0]), within([35.0, 90.0]), pip, pip * 2.0 / 3.0]
            }
        }
    }))
}

fn posed(digits: [Joints; 5]) -> Pose {
    let mut pose = Pose::REST;
    for (digit, joints) in Digit::ALL.into_iter().zip(digits) {
        for (dof, degrees) in digit.dofs().into_iter().zip(joints) {
            pose[dof] = degrees.to_radians();
        }
    }
    pose
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_postures_are_plausible_and_differ() {
        for (k, posture) in NAMED.iter().enumerate() {
            assert_eq!(posture.pose().out_of_range(), [], "{}", posture.name);
            for other in &NAMED[..k] {
                assert_ne!(posture.pose(), other.pose(), "{} and {}", posture.name, other.name);
            }
        }
    }

    #[test]
    fn digits_are_out_where_they_should_be() {
        let mut random = ItemRng::new(0, 0);
        for out in all_ways_out() {
            let pose = with_digits_out(out, &mut random);
            for (digit, out) in Digit::ALL.into_iter().zip(out) {
                let bend: f64 = digit.dofs()[1..].iter().map(|&dof| pose[dof]).sum();
                assert_eq!(bend < 0.9, out, "{digit:?} bends by {bend} rad");
            }
        }
        assert_eq!(all_ways_out().count(), 32);
    }
}
