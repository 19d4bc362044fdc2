//! Random poses and hands.

use phalanx_hand::{Dof, HandShape, sample_pose, sample_pose_independent};
use proptest::prelude::*;

use crate::property;

/// Numbers in [0, 1) that follow from a seed.
fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

proptest! {
    #![proptest_config(property::cases(256))]

    #[test]
    fn coupled_poses_are_plausible(seed: u64) {
        prop_assert_eq!(sample_pose(uniform(seed)).out_of_range(), []);
    }

    #[test]
    fn dip_follows_pip_where_coupled(seed: u64) {
        let pose = sample_pose(uniform(seed));
        let expected = (pose[Dof::IndexPip] * 2.0 / 3.0).to_degrees();
        prop_assert!((pose[Dof::IndexDip].to_degrees() - expected).abs() < 6.01);
    }

    #[test]
    fn uncoupled_angles_are_each_in_their_range(seed: u64) {
        let pose = sample_pose_independent(uniform(seed));
        for dof in Dof::ALL.into_iter().filter(|dof| dof.is_internal()) {
            let (low, high) = dof.range();
            prop_assert!((low..=high).contains(&pose[dof]), "{dof}");
        }
    }

    #[test]
    fn a_varied_hand_is_a_hand_within_the_factors(seed: u64) {
        let (adult, mut draw) = (HandShape::adult(), uniform(seed));
        let varied = adult.scaled(|| 0.9 + 0.2 * draw());
        prop_assert!(varied.validate().is_ok());
        for (new, old) in varied.fingers().iter().zip(adult.fingers()) {
            for (new, old) in new.lengths_mm.iter().zip(old.lengths_mm) {
                prop_assert!((0.9..=1.1).contains(&(new / old)));
            }
        }
    }
}

#[test]
fn every_bone_and_radius_has_a_factor_of_its_own() {
    let mut count = 0_u32;
    let adult = HandShape::adult();
    let varied = adult.scaled(|| {
        count += 1;
        1.0 + 1e-3 * f64::from(count)
    });
    // Digits: base, three bones, four radii; the palm: two at the wrist, four knuckles, two webs,
    // heel and its radius; the forearm's two widths.
    assert_eq!(count, 5 * 8 + 10 + 2);
    assert_ne!(
        varied.thumb.radii_mm[3] / adult.thumb.radii_mm[3],
        varied.index.radii_mm[3] / adult.index.radii_mm[3]
    );
}

#[test]
fn the_factor_one_changes_nothing() {
    assert_eq!(HandShape::adult().scaled(|| 1.0), HandShape::adult());
}
