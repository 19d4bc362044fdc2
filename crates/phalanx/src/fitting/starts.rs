//! Where fits begin.

use glam::{DAffine3, DMat3, DVec3};
use phalanx_hand::{Digit, Dof, HandShape, Pose, Side};
use phalanx_refine::PosePrior;

use crate::error::Result;
use crate::localize::Placement;
use crate::synthesis::postures::coupled;

/// Standard deviations of what is not known at all: any turn, anywhere within a room's reach of where the
/// fit begins. One view leaves the distance open; a wider prior would leave it without a covariance.
const ANY_TURN: f64 = std::f64::consts::PI;
const ANYWHERE_MM: f64 = 1e3;

/// How many standard deviations a joint's plausible range is wide.
const RANGE: f64 = 6.0;

/// What is known of any hand's pose: how its fingers' angles go together, how far wrists bend, and
/// nothing of where it is.
pub(super) fn pose_prior() -> Result<PosePrior> {
    let mut deviations = [f64::INFINITY; Dof::COUNT];
    for dof in [Dof::WristFlexion, Dof::WristDeviation] {
        let (low, high) = dof.range();
        deviations[dof.index()] = (high - low) / RANGE;
    }
    for dof in [Dof::ThetaX, Dof::ThetaY, Dof::ThetaZ] {
        deviations[dof.index()] = ANY_TURN;
    }
    for dof in [Dof::TX, Dof::TY, Dof::TZ] {
        deviations[dof.index()] = ANYWHERE_MM;
    }
    Ok(PosePrior::independent(Pose::REST, &deviations)?.product(coupled())?)
}

/// How a folded finger's four angles are, degrees.
const FOLDED_DEG: [f64; 4] = [0.0, 60.0, 85.0, 50.0];

/// A pose with every finger either straight or folded into the palm, in all combinations.
pub(super) fn postures(pose: &Pose) -> Vec<Pose> {
    (0..1 << Digit::FINGERS.len()).map(|folded| posture(pose, folded)).collect()
}

/// How a digit's four angles are in its distinct postures, degrees: a finger straight, bent at its knuckle alone,
/// at its other joints alone, and folded; a thumb straight, and bent across the palm.
const FINGER_DEG: [[f64; 4]; 4] =
    [[0.0; 4], [0.0, 70.0, 10.0, 5.0], [0.0, 10.0, 85.0, 50.0], FOLDED_DEG];
const THUMB_DEG: [[f64; 4]; 2] = [[20.0, 10.0, 0.0, 0.0], [20.0, 20.0, 40.0, 50.0]];

/// A pose with one digit in another posture, for each digit and each posture.
pub(super) fn each_digit(pose: &Pose) -> Vec<Pose> {
    let with = |digit: Digit, degrees: &[f64; 4]| {
        let mut pose = *pose;
        for (dof, degrees) in digit.dofs().into_iter().zip(degrees) {
            pose[dof] = degrees.to_radians();
        }
        pose
    };
    let fingers = Digit::FINGERS.into_iter();
    let fingers =
        fingers.flat_map(|digit| FINGER_DEG.iter().map(move |degrees| with(digit, degrees)));
    fingers.chain(THUMB_DEG.iter().map(|degrees| with(Digit::Thumb, degrees))).collect()
}

/// A pose with the angles of two fingers exchanged, for each pair of them, and with those of all fingers handed on to the
/// next one, either way: one finger is easily taken for its neighbour.
pub(super) fn exchanged(pose: &Pose) -> Vec<Pose> {
    let fingers = Digit::FINGERS;
    let with = |from: [usize; 4]| {
        let mut posed = *pose;
        for (finger, from) in fingers.into_iter().zip(from) {
            for (dof, from) in finger.dofs().into_iter().zip(fingers[from].dofs()) {
                posed[dof] = pose[from];
            }
        }
        posed
    };
    let pairs = (0..4).flat_map(|one| (0..one).map(move |other| (one, other)));
    let swapped = pairs.map(|(one, other)| {
        let mut from = [0, 1, 2, 3];
        from.swap(one, other);
        from
    });
    swapped.chain([[1, 2, 3, 0], [3, 0, 1, 2]]).map(with).collect()
}

/// A pose with the digits of another.
pub(super) fn with_digits(pose: &Pose, digits: &Pose) -> Pose {
    let mut posed = *pose;
    for dof in of_digits() {
        posed[dof] = digits[dof];
    }
    posed
}

/// The angles of all digits.
pub(super) fn of_digits() -> impl Iterator<Item = Dof> {
    Digit::ALL.into_iter().flat_map(Digit::dofs)
}

/// The open hand, and the fist.
pub(super) fn extremes(pose: &Pose) -> [Pose; 2] {
    [posture(pose, 0), posture(pose, (1 << Digit::FINGERS.len()) - 1)]
}

/// A pose with some fingers folded, a bit each, and the others straight.
fn posture(pose: &Pose, folded: usize) -> Pose {
    let mut pose = *pose;
    for (k, finger) in Digit::FINGERS.into_iter().enumerate() {
        let share = f64::from(u8::from(folded >> k & 1 == 1));
        for (dof, degrees) in finger.dofs().into_iter().zip(FOLDED_DEG) {
            pose[dof] = (share * degrees).to_radians();
        }
    }
    pose
}

/// The frame of a hand at rest whose wrist and arm are where they are, its back in any direction.
pub(super) fn frame_of(wrist: DVec3, arm: DVec3) -> DAffine3 {
    let z = arm.normalize_or(DVec3::Z);
    let x = z.any_orthonormal_vector();
    DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), wrist)
}

/// The frame of a posed hand: its origin at the wrist, z along the forearm towards the hand. With it for
/// the frame at rest, the same hand is at [`Pose::REST`] but for its joints.
pub(super) fn frame_at(pose: &Pose, rest: &DAffine3, hand: &HandShape) -> DAffine3 {
    let mirror = mirror(hand);
    let turn = mirror * pose.rotation() * mirror;
    DAffine3::from_mat3_translation(rest.matrix3 * turn, rest.transform_point3(pose.translation()))
}

/// A frame at a placement: its arm as seen, its back as nearly as it can be as another frame's.
pub(super) fn turned_to(placement: &Placement, frame: &DAffine3) -> DAffine3 {
    let z = placement.arm.normalize_or(DVec3::Z);
    let x = frame.matrix3.y_axis.cross(z).normalize_or(z.any_orthonormal_vector());
    DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), placement.wrist)
}

fn mirror(hand: &HandShape) -> DMat3 {
    match hand.side {
        Side::Right => DMat3::IDENTITY,
        Side::Left => DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)),
    }
}

/// The same pose of a hand with another frame at rest: `to` in place of `from`.
pub(super) fn in_frame(pose: &Pose, from: &DAffine3, to: &DAffine3, hand: &HandShape) -> Pose {
    let mirror = mirror(hand);
    let change = to.inverse() * *from;
    let rotation = mirror * change.matrix3 * mirror * pose.rotation();
    let offset = change.transform_point3(pose.translation());
    let mut moved = *pose;
    // R_X R_Y R_Z, as of `Pose::rotation`.
    moved[Dof::ThetaX] = (-rotation.z_axis.y).atan2(rotation.z_axis.z);
    moved[Dof::ThetaY] = rotation.z_axis.x.clamp(-1.0, 1.0).asin();
    moved[Dof::ThetaZ] = (-rotation.y_axis.x).atan2(rotation.x_axis.x);
    [moved[Dof::TX], moved[Dof::TY], moved[Dof::TZ]] = offset.to_array();
    moved
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn fingers_change_places_and_nothing_else_moves() {
        let mut pose = Pose::REST;
        pose[Dof::ThumbMcp] = 0.7;
        for (finger, bent) in Digit::FINGERS.into_iter().zip([0.1, 0.2, 0.3, 0.4]) {
            pose[finger.dofs()[2]] = bent;
        }
        let bent = |posed: &Pose| Digit::FINGERS.map(|finger| posed[finger.dofs()[2]]);
        let exchanged = exchanged(&pose);
        let orders: Vec<[f64; 4]> = exchanged.iter().map(bent).collect();
        for posed in &exchanged {
            let mut sorted = bent(posed);
            assert_ne!(sorted, bent(&pose));
            sorted.sort_by(f64::total_cmp);
            assert_eq!(sorted, bent(&pose));
            assert_eq!(posed[Dof::ThumbMcp], 0.7);
        }
        assert!(orders.contains(&[0.2, 0.1, 0.3, 0.4]) && orders.contains(&[0.4, 0.1, 0.2, 0.3]));
        assert!((1..orders.len()).all(|k| !orders[..k].contains(&orders[k])));
    }

    proptest! {
        #![proptest_config(crate::property::cases(256))]

        #[test]
        fn a_hand_stays_where_it_is_in_another_frame(
            numbers in prop::array::uniform28(-0.7..0.7_f64),
            wrist in prop::array::uniform3(-300.0..300.0_f64),
            arm in prop::array::uniform3(0.1..1.0_f64),
            is_left in any::<bool>(),
        ) {
            let side = if is_left { Side::Left } else { Side::Right };
            let hand = HandShape { side, ..HandShape::adult() };
            let (from, to) = (DAffine3::IDENTITY, frame_of(wrist.into(), arm.into()));
            let pose = Pose(numbers);
            let moved = in_frame(&pose, &from, &to, &hand);
            let (before, after) = (hand.pose(&pose, &from), hand.pose(&moved, &to));
            for (a, b) in before.joints.iter().zip(after.joints) {
                prop_assert!(a.distance(b) < 1e-6, "{a} is not {b}");
            }
        }
    }
}
