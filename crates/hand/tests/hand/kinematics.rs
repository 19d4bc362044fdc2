//! Properties of the forward kinematics.

use glam::{DAffine3, DMat3, DVec3};
use phalanx_hand::{Digit, Dof, FingerShape, HandShape, Pose, Primitive, Side};
use proptest::prelude::*;

use crate::property;

fn any_pose() -> impl Strategy<Value = Pose> {
    let ranges = Dof::ALL.map(Dof::range);
    ranges
        .into_iter()
        .map(|(low, high)| low..high)
        .collect::<Vec<_>>()
        .prop_map(|values| Pose(values.try_into().expect("28 ranges")))
}

/// The bones: pairs of joints, digit by digit from the base outwards.
fn bones() -> impl Iterator<Item = (usize, usize)> {
    (0..5).flat_map(|digit| (0..3).map(move |k| (1 + 4 * digit + k, 2 + 4 * digit + k)))
}

proptest! {
    #![proptest_config(property::cases(256))]

    #[test]
    fn bones_keep_their_lengths(pose in any_pose()) {
        let shape = HandShape::adult();
        let hand = shape.pose(&pose, &DAffine3::IDENTITY);
        let lengths = std::iter::once(shape.thumb.joint_distances_mm())
            .chain(shape.fingers().map(FingerShape::joint_distances_mm))
            .flatten();
        for ((from, to), length) in bones().zip(lengths) {
            prop_assert!((hand.joints[from].distance(hand.joints[to]) - length).abs() < 1e-9);
        }
    }

    #[test]
    fn global_pose_moves_the_hand_rigidly(pose in any_pose()) {
        let shape = HandShape::adult();
        let mut local = pose;
        for dof in [Dof::ThetaX, Dof::ThetaY, Dof::ThetaZ, Dof::TX, Dof::TY, Dof::TZ] {
            local[dof] = 0.0;
        }
        let there = shape.pose(&pose, &DAffine3::IDENTITY);
        let here = shape.pose(&local, &DAffine3::IDENTITY);
        for (moved, joint) in there.joints.iter().zip(here.joints) {
            let expected = pose.rotation() * joint + pose.translation();
            prop_assert!(moved.distance(expected) < 1e-9);
        }
    }

    #[test]
    fn a_left_hand_is_the_mirror_image(pose in any_pose()) {
        let right = HandShape::adult();
        let left = HandShape { side: Side::Left, ..right.clone() };
        let mut pose = pose;
        pose[Dof::TX] = 0.0;
        let mirror = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)));
        let (right, left) = (right.pose(&pose, &DAffine3::IDENTITY), left.pose(&pose, &DAffine3::IDENTITY));
        for (a, b) in right.joints.iter().zip(left.joints) {
            prop_assert!(mirror.transform_point3(*a).distance(b) < 1e-9);
        }
        for (a, b) in right.primitives.iter().zip(&left.primitives) {
            for (a, b) in a.moved(&mirror).spheres().iter().zip(b.spheres()) {
                prop_assert!(a.center.distance(b.center) < 1e-9);
            }
        }
    }

    #[test]
    fn solids_contain_their_joints(pose in any_pose()) {
        let hand = HandShape::adult().pose(&pose, &DAffine3::IDENTITY);
        for (joint, &at) in hand.joints.iter().enumerate() {
            let inside = hand.primitives.iter().any(|solid| {
                !matches!(solid, Primitive::GeneralisedCylinder { .. })
                    && solid.spheres().iter().any(|sphere| sphere.center.distance(at) <= sphere.radius)
            });
            prop_assert!(inside, "joint {joint} at {at} is outside every solid");
        }
    }
}

#[test]
fn signs_are_those_of_the_conventions() {
    let shape = HandShape::adult();
    let rest = shape.pose(&Pose::REST, &DAffine3::IDENTITY).joints;
    let with = |dof: Dof| {
        let mut pose = Pose::REST;
        pose[dof] = 0.3;
        shape.pose(&pose, &DAffine3::IDENTITY).joints
    };
    for (k, digit) in Digit::FINGERS.into_iter().enumerate() {
        let tip = 8 + 4 * k;
        let [abduction, flexions @ ..] = digit.dofs();
        for flexion in flexions {
            assert!(with(flexion)[tip].y < rest[tip].y - 3.0, "{flexion} bends towards the palm");
        }
        let outwards = with(abduction)[tip].x - rest[tip].x;
        assert!(if k < 2 { outwards > 3.0 } else { outwards < -3.0 }, "{abduction} spreads");
    }
    assert!(with(Dof::ThumbAbduction)[4].y < rest[4].y - 3.0, "the thumb leaves the palm's plane");
    assert!(with(Dof::ThumbIp)[4].x < rest[4].x - 3.0, "the thumb bends across the palm");
    assert!(with(Dof::WristFlexion)[12].y < rest[12].y - 3.0);
    assert!(with(Dof::WristDeviation)[12].x > rest[12].x + 3.0);

    let mut thumb_up = Pose::REST;
    thumb_up[Dof::ThetaZ] = std::f64::consts::FRAC_PI_2;
    let joints = shape.pose(&thumb_up, &DAffine3::IDENTITY).joints;
    assert!(joints[4].y > joints[20].y + 50.0, "the thumb is up at 90 degrees");
}

#[test]
fn an_adult_has_an_adults_measures() {
    let shape = HandShape::adult();
    let length = shape.length_mm();
    assert!((180.0..195.0).contains(&length), "hand length {length} mm");
    let breadth = shape.index.base_mm.x + shape.palm.knuckle_radii_mm[0] - shape.little.base_mm.x
        + shape.palm.knuckle_radii_mm[3];
    assert!((75.0..90.0).contains(&breadth), "hand breadth {breadth} mm");
}
