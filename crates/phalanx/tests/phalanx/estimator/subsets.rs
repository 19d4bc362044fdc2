//! Models of three cameras that are asked about some of them.

use std::sync::LazyLock;

use phalanx::{
    Cameras, Cause, Error, Estimate, Estimator, FixedPoses, LossReason, NoProgress,
    PartialTraining, Picture, Refiner, RegressorConfig, Shard, Training, Workspace,
};
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::PoseFitSettings;
use phalanx_segmentation::Mask;

use super::desk::{ESTIMATOR, closing, difference_deg, masks, mean, poses, rig, unseen};
use super::few;

/// All subsets of three cameras but the whole and the empty one.
const SUBSETS: [&[usize]; 6] = [&[0], &[1], &[0, 1], &[2], &[0, 2], &[1, 2]];

fn kernels() -> Training {
    few::kernels(80, 18)
}

fn network() -> Training {
    few::network(150, 18)
}

/// Stages and angles between those that are learnt from.
fn between() -> Vec<Pose> {
    let stages = (0..11).map(|k| (f64::from(k) + 0.5) / 11.0);
    stages.flat_map(|stage| [5.0, 20.0, 40.0, 55.0].map(|z| closing(stage, z))).collect()
}

/// More than those: of fewer a network holds none out.
fn many() -> Vec<Pose> {
    let stages = (0..20).map(|k| f64::from(k) / 19.0);
    let angles = (0..10).map(|k| 6.5 * f64::from(k));
    stages.flat_map(|stage| angles.clone().map(move |z| closing(stage, z))).collect()
}

/// Learnt from the desk, and how it errs.
fn learn(training: &Training) -> Estimator {
    let (rig, hand) = (rig(), HandShape::adult());
    let estimator = training.run(&rig, &hand, &many(), &NoProgress).unwrap();
    let scenes = FixedPoses { rig: &rig, hand: &hand, poses: &between() };
    estimator.fit_error_model(&scenes, &NoProgress).unwrap()
}

static KERNELS: LazyLock<Estimator> = LazyLock::new(|| learn(&kernels()));
static NETWORK: LazyLock<Estimator> = LazyLock::new(|| learn(&network()));

/// What an estimator says of some cameras' masks.
fn ask(estimator: &Estimator, masks: &[Mask], cameras: &[usize]) -> phalanx::Result<Estimate> {
    let picture = |view: usize| cameras.contains(&view).then_some(Picture::Mask(&masks[view]));
    let pictures: Vec<Option<Picture<'_>>> = (0..masks.len()).map(picture).collect();
    estimator.estimate(&pictures, &mut Workspace::default())
}

fn seen(estimate: &Estimate) -> Vec<usize> {
    estimate.observation.views.iter().map(|view| view.camera).collect()
}

fn answers_any_cameras(estimator: &Estimator) {
    for cameras in SUBSETS {
        let errors = unseen().into_iter().map(|pose| {
            let estimate = ask(estimator, &masks(&rig(), &pose), cameras).unwrap();
            assert_eq!(seen(&estimate), cameras);
            assert_eq!(estimate.overlaps.len(), cameras.len());
            difference_deg(&estimate.pose, &pose)
        });
        let error = mean(errors.collect::<Vec<_>>().into_iter());
        assert!(error < 5.0, "{cameras:?}: {error:.1}°");
    }
}

/// The mean deviation of the angles that vary, in what is said of all poses.
fn deviation(estimator: &Estimator, cameras: &[usize]) -> f64 {
    let of_pose = |pose: Pose| {
        let estimate = ask(estimator, &masks(&rig(), &pose), cameras).unwrap();
        let angles = Dof::ALL.into_iter().filter(|dof| dof.is_internal());
        angles.map(|dof| estimate.std[dof.index()].unwrap()).sum::<f64>()
    };
    mean(unseen().into_iter().map(of_pose))
}

fn deviates_more_from_fewer(estimator: &Estimator) {
    let of = |count: usize| {
        let subsets = SUBSETS.iter().filter(|cameras| cameras.len() == count);
        let deviations: Vec<f64> = subsets.map(|cameras| deviation(estimator, cameras)).collect();
        mean(deviations.into_iter())
    };
    let deviations = [of(1), of(2), deviation(estimator, &[0, 1, 2])];
    assert!(deviations.is_sorted_by(|fewer, more| fewer > more), "{deviations:?}");
}

/// The bytes of a training over two blocks of scenes and an error model, in one run at one thread, and in
/// parts of which one went through its file at two. Two cameras have subsets too.
fn is_the_same_in_parts(training: &Training) {
    let (rig, hand) = (rig().select(&["side", "top"]).unwrap(), HandShape::adult());
    let poses: Vec<Pose> = poses().into_iter().cycle().take(1030).collect();
    let scenes = FixedPoses { rig: &rig, hand: &hand, poses: &poses };
    let part = |shard| training.shard(&rig, &hand, &scenes, shard, &NoProgress).unwrap();
    let fresh = between();
    let fresh = FixedPoses { rig: &rig, hand: &hand, poses: &fresh[..20] };
    let finished = |part: PartialTraining| {
        let estimator = part.finish(&NoProgress).unwrap();
        estimator.fit_error_model(&fresh, &NoProgress).unwrap().to_bytes().unwrap()
    };
    let threads = |count| rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
    let whole = threads(1).install(|| finished(part(Shard::WHOLE)));
    let joined = threads(2).install(|| {
        let [first, second] = [1, 2].map(|index| part(Shard::new(index, 2).unwrap()));
        let mut read = PartialTraining::from_bytes(&second.to_bytes().unwrap()).unwrap();
        assert_eq!(read, second);
        read.merge(first).unwrap();
        finished(read)
    });
    assert!(joined == whole);
}

#[test]
fn kernels_answer_any_cameras() {
    answers_any_cameras(&KERNELS);
}

#[test]
fn a_network_answers_any_cameras() {
    answers_any_cameras(&NETWORK);
}

#[test]
fn fewer_views_deviate_more() {
    deviates_more_from_fewer(&KERNELS);
    deviates_more_from_fewer(&NETWORK);
}

#[test]
fn kernels_are_the_same_bytes_in_parts_and_at_any_number_of_threads() {
    is_the_same_in_parts(&kernels());
}

#[test]
fn a_network_is_the_same_bytes_in_parts_and_at_any_number_of_threads() {
    let mut hasty = network();
    if let RegressorConfig::Network(network) = &mut hasty.regressor {
        network.perceptron.epochs = 2;
    }
    is_the_same_in_parts(&hasty);
}

#[test]
fn all_cameras_are_answered_as_if_none_could_be_missing() {
    for (training, any) in [(kernels(), &KERNELS), (network(), &NETWORK)] {
        let all = learn(&Training { answers_from: Cameras::All, ..training });
        assert_eq!(all.regressor(), any.regressor());
        assert_eq!(all.error_model(), any.error_model());
        let masks = masks(&rig(), &unseen()[2]);
        assert_eq!(ask(&all, &masks, &[0, 1, 2]).unwrap(), ask(any, &masks, &[0, 1, 2]).unwrap());
        let error = ask(&all, &masks, &[0, 2]).unwrap_err();
        assert!(matches!(&error, Error::MissingCamera { camera } if camera == "top"), "{error}");
    }
}

#[test]
fn what_is_saved_is_loaded_and_a_cut_payload_refused() {
    for estimator in [&*KERNELS, &*NETWORK] {
        super::roads::survives_its_file(estimator);
    }
}

#[test]
fn a_view_without_a_hand_is_left_out_and_named() {
    let pose = unseen()[3];
    let mut masks = masks(&rig(), &pose);
    let without = ask(&KERNELS, &masks, &[0, 2]).unwrap();
    masks[1] = Mask::new(120, 90);
    let blank = ask(&KERNELS, &masks, &[0, 1, 2]).unwrap();
    assert_eq!((blank.pose, blank.std), (without.pose, without.std));
    assert_eq!(blank.observation, without.observation);
    let not_seen = |estimate: &Estimate| -> Vec<Cause> {
        estimate.doubts.iter().filter(|doubt| doubt.view == 1).map(|doubt| doubt.cause).collect()
    };
    assert_eq!(not_seen(&blank), [Cause::NotSeen(LossReason::NoHand)]);

    let settings = PoseFitSettings::default();
    let refiner = Refiner::for_estimator(&KERNELS, settings).unwrap();
    let refined = refiner.refine_estimate(&KERNELS, blank).unwrap().refined;
    assert_eq!(not_seen(&refined), [Cause::NotSeen(LossReason::NoHand)]);
    let error = difference_deg(&refined.pose, &pose);
    assert!(error < 3.0, "{error:.1}°");

    masks.fill(Mask::new(120, 90));
    let error = ask(&KERNELS, &masks, &[0, 1, 2]).unwrap_err();
    assert!(error.to_string().starts_with("camera 'side': empty mask"), "{error}");
    let error = ask(&KERNELS, &masks, &[]).unwrap_err();
    assert!(matches!(error, Error::PictureCount { found: 0, .. }), "{error}");
}

#[test]
fn other_regressors_need_every_camera() {
    let error = ask(&ESTIMATOR, &masks(&rig(), &unseen()[0]), &[0, 1]).unwrap_err();
    assert!(matches!(&error, Error::MissingCamera { camera } if camera == "other_side"), "{error}");
}

/// Where cameras are exchanged among those that there are, each is named by its own number.
#[test]
fn exchanged_cameras_are_named_among_those_there_are() {
    let pose = unseen()[2];
    let mut masks = masks(&rig(), &pose);
    masks.swap(0, 2);
    let pictures = [Some(Picture::Mask(&masks[0])), None, Some(Picture::Mask(&masks[2]))];
    let mut workspace = Workspace::default();
    let estimate = KERNELS.estimate(&pictures, &mut workspace).unwrap();
    let doubts = KERNELS.explain(&pictures, &estimate, &mut workspace).unwrap();
    assert!(!doubts.is_empty());
    for doubt in &doubts {
        assert!([0, 2].contains(&doubt.view), "{doubt:?}");
        if let Cause::SwappedCamera(other) = doubt.cause {
            assert_eq!(other, 2 - doubt.view);
        }
    }
}
