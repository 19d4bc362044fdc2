//! The desk rig, a hand that closes, and an estimator learnt from it.

use phalanx_segmentation::Mask;
use std::sync::LazyLock;

use phalanx::{
    Estimate, Estimator, NoProgress, OrientationRule, Picture, RegressorConfig, Training,
    Workspace, draw_silhouette,
};
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{Digit, Dof, HandShape, Pose};
use phalanx_multiview::CodebookTrainer;
use phalanx_rvm::KernelRidge;

/// A hand closed by a share of 0 to 1 and turned about the forearm.
pub(crate) fn closing(closed: f64, theta_z_deg: f64) -> Pose {
    let mut pose = Pose::REST;
    for digit in Digit::ALL {
        let grasp_deg = match digit {
            Digit::Thumb => [28.0, 25.0, 40.0, 45.0],
            _ => [-2.0, 70.0, 88.0, 55.0],
        };
        // The little finger leads, as in a grasp.
        let lead = 0.06 * digit as usize as f64;
        let done = (closed * (1.0 + lead)).min(1.0);
        for (dof, degrees) in digit.dofs().into_iter().zip(grasp_deg) {
            pose[dof] = (done * degrees).to_radians();
        }
    }
    pose[Dof::ThetaZ] = theta_z_deg.to_radians();
    pose
}

/// 60 poses: twelve stages at five angles.
pub(crate) fn poses() -> Vec<Pose> {
    let stages = (0..12).map(|k| f64::from(k) / 11.0);
    stages.flat_map(|stage| [0.0, 15.0, 30.0, 45.0, 60.0].map(|z| closing(stage, z))).collect()
}

/// Poses between those that are learnt from.
pub(crate) fn unseen() -> Vec<Pose> {
    [(0.04, 7.0), (0.22, 38.0), (0.41, 52.0), (0.59, 22.0), (0.77, 8.0), (0.95, 37.0)]
        .map(|(stage, z)| closing(stage, z))
        .into()
}

pub(crate) fn rig() -> Rig {
    Rig::from_toml(include_str!("../../../fixtures/desk.toml")).unwrap()
}

pub(crate) fn top() -> Rig {
    rig().select(&["top"]).unwrap()
}

/// Thirty centres and little patience: enough for so few poses.
pub(crate) fn training(orientation: OrientationRule) -> Training {
    let mut vocabulary =
        CodebookTrainer { centres: 30, most_samples: 4000, ..CodebookTrainer::default() };
    vocabulary.clustering.restarts = 1;
    // The penalty by leave-one-out: what is asked about lies between what is learnt.
    let regressor = RegressorConfig::KernelRidge(KernelRidge::default());
    Training { orientation, vocabulary, regressor, ..Training::default() }
}

fn learn(rig: &Rig, orientation: OrientationRule) -> Estimator {
    training(orientation).run(rig, &HandShape::adult(), &poses(), &NoProgress).unwrap()
}

/// Three views by the forearm's axis.
pub(crate) static ESTIMATOR: LazyLock<Estimator> =
    LazyLock::new(|| learn(&rig(), OrientationRule::default()));

/// One view by the forearm's axis.
pub(crate) static FROM_TOP: LazyLock<Estimator> =
    LazyLock::new(|| learn(&top(), OrientationRule::default()));

/// One view by the image's axes.
pub(crate) static UNTURNED: LazyLock<Estimator> =
    LazyLock::new(|| learn(&top(), OrientationRule::ImageAxes));

/// The masks of a pose in every camera of a rig.
pub(crate) fn masks(rig: &Rig, pose: &Pose) -> Vec<Mask> {
    let rest = rig.volume.rest_frame();
    let draw = |camera| draw_silhouette(camera, &HandShape::adult(), pose, &rest).unwrap();
    rig.cameras.iter().map(draw).collect()
}

/// A rig whose cameras take larger or smaller pictures of the same.
pub(crate) fn resized(rig: &Rig, width: u32, height: u32) -> Rig {
    let resize = |camera: &Camera| camera.with_intrinsics(camera.intrinsics.resized(width, height));
    Rig { cameras: rig.cameras.iter().map(resize).collect(), volume: rig.volume }
}

/// The estimate from masks, in memory of its own.
pub(crate) fn estimate(estimator: &Estimator, masks: &[Mask]) -> phalanx::Result<Estimate> {
    let pictures: Vec<_> = masks.iter().map(Picture::Mask).collect();
    estimator.estimate(&pictures, &mut Workspace::default())
}

/// Mean absolute difference of the angles that vary, degrees.
pub(crate) fn difference_deg(a: &Pose, b: &Pose) -> f64 {
    let varying = || Dof::ALL.into_iter().take(Dof::INTERNAL).chain([Dof::ThetaZ]);
    let sum: f64 = varying().map(|dof| (a[dof] - b[dof]).abs()).sum();
    (sum / varying().count() as f64).to_degrees()
}

pub(crate) fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}
