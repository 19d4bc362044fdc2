//! Residual codes, coverage and learnt distances: the road of the fast preset, made small.

use std::sync::LazyLock;

use phalanx::{
    Description, Error, Estimator, LearntMetric, NominalScenes, Preset, Regression, Regressor,
    Shard, Silent, Training,
};
use phalanx_hand::HandShape;

use crate::desk::{difference_deg, estimate, masks, mean, poses, top, unseen};

/// The fast preset with few of everything.
fn training() -> Training {
    let preset = Preset::Fast.training();
    let Regressor::LearntMetric(learnt) = preset.regressor else { unreachable!("it learns one") };
    let mut metric = learnt.metric;
    (metric.centres, metric.gradients, metric.rank) = (40, 30, 6);
    let regressor =
        Regressor::LearntMetric(LearntMetric { components: 20, centres: 40, metric, ..learnt });
    let mut vocabulary = preset.vocabulary;
    (vocabulary.centres, vocabulary.most_samples) = (6, 2000);
    Training { vocabulary, regressor, ..preset }
}

static LEARNT: LazyLock<Estimator> =
    LazyLock::new(|| training().run(&top(), &HandShape::adult(), &poses(), &Silent).unwrap());

#[test]
fn poses_between_those_learnt_are_estimated() {
    let errors: Vec<f64> = unseen()
        .iter()
        .map(|pose| difference_deg(&estimate(&LEARNT, &masks(&top(), pose)).unwrap().pose, pose))
        .collect();
    assert!(mean(errors.iter().copied()) < 3.0, "{errors:?}");
}

#[test]
fn every_angle_that_varies_has_a_deviation() {
    let found = estimate(&LEARNT, &masks(&top(), &unseen()[3])).unwrap();
    for dof in phalanx_hand::Dof::ALL.into_iter().filter(|dof| dof.is_internal()) {
        assert!(found.std[dof.index()] > 0.0 && found.std[dof.index()] < 0.5, "{dof}");
    }
}

#[test]
fn any_number_of_threads_learns_the_same_bytes() {
    let bytes = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let learnt = training().run(&top(), &HandShape::adult(), &poses(), &Silent);
            learnt.unwrap().to_bytes().unwrap()
        })
    };
    assert!(bytes(1) == bytes(2));
}

#[test]
fn what_is_saved_is_loaded_and_a_cut_payload_refused() {
    let bytes = LEARNT.to_bytes().unwrap();
    assert_eq!(&Estimator::from_bytes(&bytes).unwrap(), &*LEARNT);
    assert!(matches!(LEARNT.regression(), Regression::Projected(_)));
    for length in (0..bytes.len()).step_by(bytes.len() / 40) {
        assert!(Estimator::from_bytes(&bytes[..length]).is_err());
    }
}

#[test]
fn a_part_is_saved_and_loaded_and_finishes_to_the_same() {
    let (rig, hand, poses) = (top(), HandShape::adult(), poses());
    let scenes = NominalScenes { rig: &rig, hand: &hand, poses: &poses };
    let part = training().shard(&rig, &hand, &scenes, Shard::WHOLE, &Silent).unwrap();
    let read = phalanx::Part::from_bytes(&part.to_bytes().unwrap()).unwrap();
    assert_eq!(read, part);
    assert_eq!(&read.finish(&Silent).unwrap(), &*LEARNT);
}

#[test]
fn what_needs_its_samples_at_once_does_not_learn_from_residuals() {
    let training = Training { description: Description::Residuals, ..Training::default() };
    let refused = training.run(&top(), &HandShape::adult(), &poses(), &Silent);
    assert!(matches!(refused, Err(Error::NotInShards { .. })));
}
