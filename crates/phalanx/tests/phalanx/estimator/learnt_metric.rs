//! Residual codes, coverage and learnt distances: the road of the fast preset, made small.

use std::sync::LazyLock;

use phalanx::{Encoding, Estimator, FittedRegressor, FixedPoses, NoProgress, Shard, Training};
use phalanx_hand::HandShape;

use super::desk::{poses, top};
use super::few;
use super::roads;

fn training() -> Training {
    few::kernels(40, 6)
}

static LEARNT: LazyLock<Estimator> =
    LazyLock::new(|| training().run(&top(), &HandShape::adult(), &poses(), &NoProgress).unwrap());

#[test]
fn poses_between_those_learnt_are_estimated() {
    roads::generalises(&LEARNT);
}

#[test]
fn every_angle_that_varies_has_a_deviation() {
    roads::has_deviations(&LEARNT);
}

#[test]
fn any_number_of_threads_learns_the_same_bytes() {
    let bytes = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let learnt = training().run(&top(), &HandShape::adult(), &poses(), &NoProgress);
            learnt.unwrap().to_bytes().unwrap()
        })
    };
    assert!(bytes(1) == bytes(2));
}

#[test]
fn what_is_saved_is_loaded_and_a_cut_payload_refused() {
    assert!(matches!(LEARNT.regressor(), FittedRegressor::Projected(_)));
    roads::survives_its_file(&LEARNT);
}

#[test]
fn a_part_is_saved_and_loaded_and_finishes_to_the_same() {
    let (rig, hand, poses) = (top(), HandShape::adult(), poses());
    let scenes = FixedPoses { rig: &rig, hand: &hand, poses: &poses };
    let part = training().shard(&rig, &hand, &scenes, Shard::WHOLE, &NoProgress).unwrap();
    let read = phalanx::PartialTraining::from_bytes(&part.to_bytes().unwrap()).unwrap();
    assert_eq!(read, part);
    assert_eq!(&read.finish(&NoProgress).unwrap(), &*LEARNT);
}

#[test]
fn what_keeps_its_samples_learns_from_residuals_too() {
    let training = Training { encoding: Encoding::Vlad, ..Training::default() };
    let learnt = training.run(&top(), &HandShape::adult(), &poses(), &NoProgress).unwrap();
    roads::generalises(&learnt);
}
