//! The closed-form derivative of forward kinematics against central differences.

use glam::{DAffine3, DQuat, DVec3};
use phalanx_hand::{Dof, HandShape, Pose, Side};
use proptest::prelude::*;

use crate::property;

const STEP: f64 = 1e-5;

proptest! {
    #![proptest_config(property::cases(32))]

    #[test]
    fn spheres_move_as_the_motions_say(
        numbers in prop::array::uniform28(-1.0..1.0_f64),
        side in prop_oneof![Just(Side::Right), Just(Side::Left)],
        turn in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        let shape = HandShape { side, ..HandShape::adult() };
        let rotation = DQuat::from_scaled_axis(DVec3::from_array(turn));
        let rest = DAffine3::from_rotation_translation(rotation, DVec3::new(3.0, -70.0, 11.0));
        let pose = Pose(numbers);
        let (hand, twists) = (shape.pose(&pose, &rest), shape.twists(&pose, &rest));
        for dof in Dof::ALL {
            let shifted = |step: f64| {
                let mut shifted = pose;
                shifted[dof] += step;
                shape.pose(&shifted, &rest)
            };
            let (ahead, behind) = (shifted(STEP), shifted(-STEP));
            for (solid, bones) in hand.bones.iter().enumerate() {
                for (k, sphere) in hand.primitives[solid].spheres().iter().enumerate() {
                    let (a, b) = (ahead.primitives[solid].spheres()[k], behind.primitives[solid].spheres()[k]);
                    let slope = (a.center - b.center) / (2.0 * STEP);
                    let velocity = twists.of(dof).velocity(sphere.center);
                    let velocity = if bones[k].is_moved_by(dof) { velocity } else { DVec3::ZERO };
                    prop_assert!(
                        slope.abs_diff_eq(velocity, 1e-5),
                        "{dof}, solid {solid}, sphere {k}: {slope} is not {velocity}"
                    );
                }
            }
        }
    }
}
