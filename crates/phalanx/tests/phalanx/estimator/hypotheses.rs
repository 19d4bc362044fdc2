//! Several poses behind one picture.

use std::sync::LazyLock;

use phalanx::{Error, Estimator, FixedPoses, NoProgress, Picture, Refiner, Workspace};
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::PoseFitSettings;

use super::desk::{FROM_TOP, closing, difference_deg, estimate, masks, mean, top, unseen};

/// Stages and angles between those that were learnt from.
fn between() -> Vec<Pose> {
    let stages = (0..11).map(|k| (f64::from(k) + 0.5) / 11.0);
    stages.flat_map(|stage| [5.0, 20.0, 40.0, 55.0].map(|z| closing(stage, z))).collect()
}

fn learn() -> phalanx::Result<Estimator> {
    let (rig, hand, poses) = (top(), HandShape::adult(), between());
    let scenes = FixedPoses { rig: &rig, hand: &hand, poses: &poses };
    FROM_TOP.clone().fit_error_model(&scenes, &NoProgress)
}

static LEARNT: LazyLock<Estimator> = LazyLock::new(|| learn().unwrap());

#[test]
fn the_first_is_the_estimate_and_the_nearest_is_nearer() {
    let (mut first, mut nearest) = (Vec::new(), Vec::new());
    for pose in between() {
        let estimate = estimate(&LEARNT, &masks(&top(), &pose)).unwrap();
        let hypotheses = LEARNT.hypotheses(&estimate, 5).unwrap();
        assert_eq!(hypotheses[0].pose, estimate.pose);
        let weights: f64 = hypotheses.iter().map(|hypothesis| hypothesis.weight).sum();
        assert!((weights - 1.0).abs() < 1e-12);
        let errors = hypotheses.iter().map(|hypothesis| difference_deg(&hypothesis.pose, &pose));
        first.push(difference_deg(&estimate.pose, &pose));
        nearest.push(errors.fold(f64::INFINITY, f64::min));
        // What no pose varies in is as it was, and not estimated.
        for hypothesis in &hypotheses {
            assert_eq!(hypothesis.pose[Dof::ThetaX], estimate.pose[Dof::ThetaX]);
            assert_eq!(hypothesis.std[Dof::ThetaX.index()], None);
        }
    }
    let (first, nearest) = (mean(first.into_iter()), mean(nearest.into_iter()));
    assert!(nearest < 0.95 * first, "{nearest} {first}");
}

/// Poses that stand for all refined ones: as many as are asked for, all different, the same in whatever
/// order their starts come, and one of them nearer to the truth than the first alone.
#[test]
fn refined_poses_stand_for_all_that_came_out() {
    let refiner = Refiner::for_estimator(&LEARNT, PoseFitSettings::default()).unwrap();
    let (mut first, mut nearest) = (Vec::new(), Vec::new());
    for pose in unseen() {
        let masks = masks(&top(), &pose);
        let mut workspace = Workspace::default();
        let pictures: Vec<_> = masks.iter().map(Picture::Mask).collect();
        let estimate = LEARNT.estimate(&pictures, &mut workspace).unwrap();
        let evidence = refiner.evidence_of(&estimate.observation).unwrap();
        let mut starts = LEARNT.hypotheses(&estimate, Refiner::starts(1)).unwrap();
        assert!(starts.len() > Refiner::POSES);
        let poses: Vec<Pose> = (refiner.refine_hypotheses(&evidence, &estimate, &starts).unwrap())
            .into_iter()
            .map(|refined| refined.pose)
            .collect();
        assert_eq!(poses.len(), Refiner::POSES);
        for (k, one) in poses.iter().enumerate() {
            assert!(poses[..k].iter().all(|other| difference_deg(one, other) > 0.0));
        }
        starts.reverse();
        let again = refiner.refine_hypotheses(&evidence, &estimate, &starts).unwrap();
        assert!(again.iter().zip(&poses).all(|(again, pose)| again.pose == *pose));
        first.push(difference_deg(&poses[0], &pose));
        let errors = poses.iter().map(|refined| difference_deg(refined, &pose));
        nearest.push(errors.fold(f64::INFINITY, f64::min));
    }
    let (first, nearest) = (mean(first.into_iter()), mean(nearest.into_iter()));
    assert!(nearest < 0.95 * first, "{nearest} {first}");
}

#[test]
fn what_is_learnt_is_saved_and_is_the_same_at_any_number_of_threads() {
    let bytes = LEARNT.to_bytes().unwrap();
    assert_eq!(Estimator::from_bytes(&bytes).unwrap(), *LEARNT);
    assert!(bytes != FROM_TOP.to_bytes().unwrap());
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(pool.install(learn).unwrap().to_bytes().unwrap() == bytes, "{threads} threads");
    }
}

#[test]
fn what_cannot_be_answered_is_named() {
    let estimate = estimate(&FROM_TOP, &masks(&top(), &unseen()[0])).unwrap();
    assert!(matches!(FROM_TOP.hypotheses(&estimate, 5), Err(Error::NoErrorModel)));
    for most in [0, 1000] {
        assert!(matches!(LEARNT.hypotheses(&estimate, most), Err(Error::Regression(_))));
    }
    let (rig, hand) = (top(), HandShape::adult());
    let none = FixedPoses { rig: &rig, hand: &hand, poses: &[] };
    let error = FROM_TOP.clone().fit_error_model(&none, &NoProgress).unwrap_err();
    assert!(matches!(error, Error::TooFewPoses { found: 0 }), "{error}");
}
