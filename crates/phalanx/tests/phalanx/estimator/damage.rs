//! Damaged scenes: each part of the damage does what it says, and no more.

use glam::DVec3;
use phalanx::{
    Augmentation, FixedPoses, MaskNoise, OrientationRule, Scene, SceneDescriber, SceneSource,
    ShapeVariation, draw_silhouette,
};
use phalanx_camera::{Camera, Extrinsics};
use phalanx_hand::{HandShape, Pose};
use phalanx_segmentation::Mask;

use super::desk::{rig as desk, unseen};

fn masks(scene: &Scene) -> Vec<Mask> {
    let mut describer = SceneDescriber::new(&desk(), OrientationRule::default()).unwrap();
    describer.silhouettes(scene).unwrap().map(|silhouette| silhouette.mask.clone()).collect()
}

fn overlap(a: &Mask, b: &Mask) -> f64 {
    let pixels = || a.iter().zip(b.iter()).map(|(a, b)| (*a > 127, *b > 127));
    let both = pixels().filter(|&(a, b)| a && b).count();
    both as f64 / pixels().filter(|&(a, b)| a || b).count() as f64
}

fn scene(damage: &Augmentation, number: usize) -> Scene {
    damage.scene(&desk(), &HandShape::adult(), unseen()[0], 7, number)
}

#[test]
fn without_damage_a_scene_is_nominal() {
    let nominal = Scene::nominal(&desk(), &HandShape::adult(), unseen()[0]);
    let undamaged = scene(&Augmentation::NONE, 3);
    assert_eq!(undamaged.hand, nominal.hand);
    assert_eq!(undamaged.pose, nominal.pose);
    for (a, b) in masks(&undamaged).iter().zip(masks(&nominal)) {
        assert!(overlap(a, &b) > 0.999);
    }
}

/// A moved camera, drawn with its own extrinsics, sees what the scene says that it sees.
#[test]
fn a_turned_camera_sees_the_hand_turned_the_other_way() {
    let damage = Augmentation { camera_turn: 0.05..=0.05, ..Augmentation::NONE };
    let (rig, turned) = (desk(), scene(&damage, 0));
    for ((camera, view), mask) in rig.cameras.iter().zip(&turned.views).zip(masks(&turned)) {
        let rest = rig.volume.rest_frame();
        let moved = view.rest * rest.inverse();
        // x_cam = R x + t of a world that has moved is R M x + (R m + t) of one that has not.
        let Extrinsics { rotation, translation } = camera.extrinsics;
        let extrinsics = Extrinsics {
            rotation: rotation * moved.matrix3,
            translation: rotation * moved.translation + translation,
        };
        let elsewhere = Camera { extrinsics, ..camera.clone() };
        let distance = elsewhere.centre().distance(camera.centre());
        let expected = 2.0 * 0.025_f64.sin() * 700.0;
        assert!(distance <= expected * 1.01, "{distance} mm");
        let centre = rig.volume.center;
        let (was, is) = (camera.centre() - centre, elsewhere.centre() - centre);
        assert!((was.length() - is.length()).abs() < 1e-6, "it stays as far away");
        let drawn = draw_silhouette(&elsewhere, &HandShape::adult(), &turned.pose, &rest).unwrap();
        assert!(overlap(&drawn, &mask) > 0.98, "{}", camera.name);
    }
}

#[test]
fn a_rolled_camera_stays_where_it_is_and_looks_where_it_did() {
    let damage = Augmentation { camera_roll: 0.5, ..Augmentation::NONE };
    let rig = desk();
    for (camera, view) in rig.cameras.iter().zip(&scene(&damage, 0).views) {
        let moved = view.rest * rig.volume.rest_frame().inverse();
        let ahead: DVec3 = camera.centre() + 500.0 * camera.extrinsics.rotation.row(2);
        assert!(moved.transform_point3(ahead).distance(ahead) < 1e-6);
        assert!(moved.transform_point3(camera.centre()).distance(camera.centre()) < 1e-6);
    }
}

#[test]
fn ragged_borders_are_cleaned_to_nearly_what_they_were() {
    let damage = Augmentation { mask_noise: MaskNoise::Boundary, ..Augmentation::NONE };
    let clean = masks(&scene(&Augmentation::NONE, 0));
    let mut least: f64 = 1.0;
    for number in 0..20 {
        for (ragged, clean) in masks(&scene(&damage, number)).iter().zip(&clean) {
            least = least.min(overlap(ragged, clean));
        }
    }
    // A dilated hand of 45 pixels' breadth is 5 % larger on its own.
    assert!((0.8..0.97).contains(&least), "{least}");
}

#[test]
fn eight_hands_take_turns_and_none_is_the_given_one() {
    let damage = Augmentation {
        hands: ShapeVariation::Several { count: 8, spread: 0.1 },
        ..Augmentation::NONE
    };
    let hands: Vec<HandShape> = (0..16).map(|number| scene(&damage, number).hand).collect();
    assert_eq!(hands[..8], hands[8..]);
    for (k, hand) in hands[..8].iter().enumerate() {
        assert_ne!(*hand, HandShape::adult());
        assert!(!hands[..k].contains(hand), "hand {k} comes twice");
    }
}

#[test]
fn a_scene_depends_on_its_number_and_the_seed_alone() {
    let damage = Augmentation {
        hands: ShapeVariation::Each { spread: 0.1 },
        camera_turn: 0.0..=0.05,
        camera_roll: 0.5,
        mask_noise: MaskNoise::Boundary,
    };
    assert_eq!(scene(&damage, 5), scene(&damage, 5));
    assert_ne!(scene(&damage, 5), scene(&damage, 6));
    let other = damage.scene(&desk(), &HandShape::adult(), unseen()[0], 8, 5);
    assert_ne!(scene(&damage, 5), other);
}

#[test]
fn nominal_scenes_are_the_poses() {
    let (rig, hand, poses) = (desk(), HandShape::adult(), [Pose::REST, unseen()[0]]);
    let scenes = FixedPoses { rig: &rig, hand: &hand, poses: &poses };
    assert_eq!(scenes.count(), 2);
    assert_eq!(scenes.scene(1).pose, unseen()[0]);
}
