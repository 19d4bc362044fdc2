//! How well a fitted pose is known: what must hold of any hand before the desk's cameras.

mod desk;
mod property;

use desk::{bent, rig};
use glam::DVec2;
use phalanx_hand::{Dof, HandShape, JOINTS, Landmark, Landmarks, Pose};
use phalanx_refine::{LandmarkObservation, PoseFitSettings, PosePrior, Posterior, ShapePrior};
use proptest::prelude::*;

/// How well a pose is known from its joints in all pictures, where points are off by so many pixels.
fn known(pose: &Pose, points_px: f64, prior: [f64; Dof::COUNT], hand_std: f64) -> Posterior {
    let (rig, hand) = (rig(), HandShape::adult());
    let rest = rig.volume.rest_frame();
    let joints = hand.pose(pose, &rest).joints;
    let seen: Vec<LandmarkObservation> = rig
        .cameras
        .iter()
        .map(|camera| {
            let of = |joint: usize| {
                Some(Landmark::sure(camera.project(joints[joint])? + DVec2::splat(0.1)))
            };
            let points: Landmarks = std::array::from_fn(of);
            LandmarkObservation::new(camera, &points, points_px).unwrap()
        })
        .collect();
    let prior = PosePrior::independent(*pose, &prior).unwrap();
    let proportions = ShapePrior { size: hand_std, thickness: hand_std, each: hand_std };
    let proportions = proportions.deviations(&hand);
    PoseFitSettings::default().posterior(&hand, &rest, &seen, pose, &prior, &proportions).unwrap()
}

/// Radians of an angle, millimetres of a place.
fn vague() -> [f64; Dof::COUNT] {
    Dof::ALL.map(|dof| if [Dof::TX, Dof::TY, Dof::TZ].contains(&dof) { 50.0 } else { 0.7 })
}

fn assert_no_more(one: &[f64], other: &[f64]) -> Result<(), TestCaseError> {
    for (k, (one, other)) in one.iter().zip(other).enumerate() {
        prop_assert!(*one <= other * (1.0 + 1e-6), "number {}: {} and {}", k, one, other);
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::property::cases(24))]

    #[test]
    fn what_is_seen_takes_nothing_from_what_was_known(
        bends in prop::array::uniform5(0.1..1.1_f64),
        points_px in 0.5..20.0_f64,
        hand_std in 0.001..0.3_f64,
    ) {
        let posterior = known(&bent(bends), points_px, vague(), hand_std);
        assert_no_more(&posterior.std, &vague())?;
        prop_assert!(posterior.std.iter().chain(&posterior.joints).all(|std| *std > 0.0));
    }

    #[test]
    fn worse_points_and_a_hand_that_is_less_known_tell_less(
        bends in prop::array::uniform5(0.1..1.1_f64),
        points_px in 0.5..10.0_f64,
        hand_std in 0.002..0.1_f64,
        factor in 1.0..4.0_f64,
    ) {
        let pose = bent(bends);
        let better = known(&pose, points_px, vague(), hand_std);
        let others = [
            known(&pose, factor * points_px, vague(), hand_std),
            known(&pose, points_px, vague(), factor * hand_std),
        ];
        for worse in others {
            assert_no_more(&better.std, &worse.std)?;
            assert_no_more(&better.joints, &worse.joints)?;
        }
    }

    /// Of one number that is not known, each joint is as far off as that number moves it.
    #[test]
    fn joints_are_off_as_their_numbers_are(
        bends in prop::array::uniform5(0.1..1.1_f64),
        free in 0..Dof::COUNT,
    ) {
        let pose = bent(bends);
        let mut prior = [0.0; Dof::COUNT];
        prior[free] = vague()[free];
        // Next to nothing is seen, so that the number is as free as its prior and its range leave it.
        let Posterior { std, joints } = known(&pose, 1e4, prior, 1e-3);
        let (hand, rest) = (HandShape::adult(), rig().volume.rest_frame());
        let moved = |by: f64| {
            let mut pose = pose;
            pose.0[free] += by;
            hand.pose(&pose, &rest).joints
        };
        let step = 1e-4;
        let (behind, ahead) = (moved(-step), moved(step));
        for joint in 0..JOINTS {
            let slope = (ahead[joint] - behind[joint]).length() / (2.0 * step);
            // Proportions known to a thousandth move a joint by a fifth of a millimetre.
            let wanted = slope * std[free];
            prop_assert!((joints[joint] - wanted).abs() < 0.3 + 1e-3 * wanted,
                "joint {}: {} mm, {} mm wanted", joint, joints[joint], wanted);
        }
    }
}
