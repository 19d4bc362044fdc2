//! Learning: reproducible, with any regressor, refusing what cannot be learnt from.

use std::sync::Mutex;

use phalanx::{Error, NoProgress, OrientationRule, Progress, RegressorConfig, Training};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose, Side};
use phalanx_rvm::{
    AgarwalTriggs, Kernel, OrthogonalLeastSquares, RelevanceVectorMachine, Ridge, Stop,
    TwoStageSelection,
};

use super::desk::{ESTIMATOR, difference_deg, estimate, masks, poses, rig, top, training, unseen};

fn train(rig: &Rig, poses: &[Pose]) -> phalanx::Result<phalanx::Estimator> {
    training(OrientationRule::default()).run(rig, &HandShape::adult(), poses, &NoProgress)
}

#[test]
fn the_same_bytes_at_any_number_of_threads() {
    let expected = ESTIMATOR.to_bytes().unwrap();
    for threads in [1, 2, 8] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let bytes = pool.install(|| train(&rig(), &poses()).unwrap().to_bytes().unwrap());
        assert!(bytes == expected, "{threads} threads");
    }
}

#[test]
fn every_regressor_learns() {
    let regressors = [
        RegressorConfig::Ridge(Ridge::default()),
        RegressorConfig::Bridges(AgarwalTriggs {
            kernel: Kernel::Linear,
            stop: Stop::Count(12),
            ..AgarwalTriggs::default()
        }),
        RegressorConfig::Cascade(TwoStageSelection {
            features: Stop::Count(20),
            samples: Stop::Count(20),
            ..TwoStageSelection::default()
        }),
        RegressorConfig::Forward(OrthogonalLeastSquares {
            count: 20,
            ..OrthogonalLeastSquares::default()
        }),
        RegressorConfig::Tipping(RelevanceVectorMachine {
            kernel: Kernel::Linear,
            ..RelevanceVectorMachine::default()
        }),
    ];
    for regressor in regressors {
        let name = format!("{regressor:?}");
        let training = Training { regressor, ..training(OrientationRule::default()) };
        let estimator = training.run(&top(), &HandShape::adult(), &poses(), &NoProgress).unwrap();
        let loaded = phalanx::Estimator::from_bytes(&estimator.to_bytes().unwrap()).unwrap();
        assert_eq!(loaded, estimator);
        let pose = unseen()[3];
        let found = estimate(&loaded, &masks(&top(), &pose)).unwrap();
        let error = difference_deg(&found.pose, &pose);
        assert!(error < 8.0, "{error:.2} degrees by {name}");
    }
}

#[test]
fn every_orientation_learns() {
    for rule in [
        OrientationRule::Tangent,
        OrientationRule::Centroid,
        OrientationRule::PrincipalAxis,
        OrientationRule::HandAxis,
    ] {
        let estimator =
            training(rule).run(&top(), &HandShape::adult(), &poses(), &NoProgress).unwrap();
        assert_eq!(estimator.orientation(), rule);
        let pose = unseen()[3];
        let found = estimate(&estimator, &masks(&top(), &pose)).unwrap();
        let error = difference_deg(&found.pose, &pose);
        assert!(error < 5.0, "{error:.2} degrees by {rule:?}");
    }
}

#[test]
fn a_left_hand_in_a_mirrored_rig_is_learnt_alike() {
    // Seen from straight above, a left hand is the mirror image of a right one.
    let left = HandShape { side: Side::Left, ..HandShape::adult() };
    let training = training(OrientationRule::default());
    let estimator = training.run(&top(), &left, &poses(), &NoProgress).unwrap();
    let pose = unseen()[1];
    let mirrored: Vec<phalanx::Mask> = masks(&top(), &pose)
        .iter()
        .map(|mask| image::imageops::flip_vertical(&**mask).into())
        .collect();
    let found = estimate(&estimator, &mirrored).unwrap();
    let error = difference_deg(&found.pose, &pose);
    assert!(error < 4.0, "{error:.2} degrees");
}

/// Remembers what it is told.
#[derive(Default)]
struct Diary(Mutex<Vec<(String, usize, usize)>>);

impl Progress for Diary {
    fn begin(&self, stage: &str, items: usize) {
        self.0.lock().unwrap().push((stage.to_owned(), items, 0));
    }
    fn step(&self) {
        self.0.lock().unwrap().last_mut().unwrap().2 += 1;
    }
}

#[test]
fn progress_tells_every_step() {
    let diary = Diary::default();
    let training = training(OrientationRule::default());
    training.run(&top(), &HandShape::adult(), &poses()[..20], &diary).unwrap();
    let stages = diary.0.into_inner().unwrap();
    assert_eq!(stages[0], ("render and describe".to_owned(), 20, 20));
    assert!(stages.iter().all(|(_, items, done)| items == done), "{stages:?}");
}

#[test]
fn too_few_poses_are_refused() {
    for few in 0..2 {
        let error = train(&rig(), &poses()[..few]).unwrap_err();
        assert!(matches!(error, Error::TooFewPoses { found } if found == few));
    }
}

#[test]
fn a_pose_that_cannot_be_seen_is_named() {
    let mut poses = poses();
    // First in the list, though a later one is wrong too.
    poses[7][Dof::TX] = 5000.0;
    poses[9][Dof::IndexPip] = f64::NAN;
    let message = train(&rig(), &poses).unwrap_err().to_string();
    assert!(message.starts_with("training pose 7: camera 'side': "), "{message}");
    poses.swap(7, 9);
    let message = train(&rig(), &poses).unwrap_err().to_string();
    assert!(message.starts_with("training pose 7: camera 'side': "), "{message}");
}

#[test]
fn rigs_hands_and_vocabularies_are_checked() {
    let mut twins = rig();
    twins.cameras[1] = twins.cameras[0].clone();
    assert!(matches!(train(&twins, &poses()), Err(Error::Rig(_))));
    let mut hand = HandShape::adult();
    hand.index.lengths_mm[0] = f64::NAN;
    let rule = OrientationRule::default();
    let error = training(rule).run(&rig(), &hand, &poses(), &NoProgress).unwrap_err();
    assert!(error.to_string().contains("index.lengths_mm[0]"), "{error}");
}

#[test]
fn equal_poses_are_learnt_as_their_mean() {
    let pose = unseen()[0];
    let estimator = train(&top(), &[pose; 4]);
    // Four equal contours still differ along themselves, so codebooks can be had.
    let found = estimate(&estimator.unwrap(), &masks(&top(), &unseen()[4])).unwrap();
    assert!(difference_deg(&found.pose, &pose) < 1e-9);
}
