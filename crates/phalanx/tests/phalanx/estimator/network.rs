//! Residual codes, coverage and a network: the road of the default preset, made small.

use std::sync::LazyLock;

use phalanx::{
    Error, Estimator, FittedRegressor, FixedPoses, NoProgress, PartialTraining, RegressorConfig,
    Shard, Training,
};
use phalanx_hand::{HandShape, Pose};

use super::desk::{poses, top};
use super::few;
use super::roads;

fn training() -> Training {
    few::network(400, 6)
}

static LEARNT: LazyLock<Estimator> =
    LazyLock::new(|| training().run(&top(), &HandShape::adult(), &poses(), &NoProgress).unwrap());

/// As quick to learn as can be.
fn hasty() -> Training {
    let mut training = training();
    if let RegressorConfig::Network(network) = &mut training.regressor {
        network.perceptron.epochs = 2;
    }
    training
}

/// The part of a shard, over more than one block of scenes.
fn part(shard: Shard) -> PartialTraining {
    let (rig, hand) = (top(), HandShape::adult());
    let poses: Vec<Pose> = poses().into_iter().cycle().take(1030).collect();
    let scenes = FixedPoses { rig: &rig, hand: &hand, poses: &poses };
    hasty().shard(&rig, &hand, &scenes, shard, &NoProgress).unwrap()
}

#[test]
fn poses_between_those_learnt_are_estimated() {
    roads::generalises(&LEARNT);
}

#[test]
fn every_angle_that_varies_has_a_deviation() {
    roads::has_deviations(&LEARNT);
}

#[test]
fn what_is_saved_is_loaded_and_a_cut_payload_refused() {
    assert!(matches!(LEARNT.regressor(), FittedRegressor::Network(_)));
    roads::survives_its_file(&LEARNT);
}

#[test]
fn parts_in_any_order_and_threads_are_the_bytes_of_one_run() {
    let whole = part(Shard::WHOLE).finish(&NoProgress).unwrap().to_bytes().unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    let joined = pool.install(|| {
        let [first, second] = [1, 2].map(|index| part(Shard::new(index, 2).unwrap()));
        let mut read = PartialTraining::from_bytes(&second.to_bytes().unwrap()).unwrap();
        assert_eq!(read, second);
        read.merge(first).unwrap();
        read.finish(&NoProgress).unwrap().to_bytes().unwrap()
    });
    assert!(joined == whole);
}

#[test]
fn a_part_whose_samples_are_not_its_blocks_is_refused() {
    let mut both = part(Shard::new(1, 2).unwrap());
    let error = both.merge(both.clone()).unwrap_err();
    assert!(matches!(error, Error::Overlap { .. }), "{error}");
}

#[test]
fn a_network_learns_in_shards_only() {
    let x = faer::Mat::from_fn(2, 4, |i, j| (i + j) as f64);
    assert!(matches!(hasty().regressor.fit(&x, &x), Err(Error::InShardsOnly { .. })));
}
