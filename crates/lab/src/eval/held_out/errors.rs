//! How far estimates are from the truth.

use faer::{Mat, MatRef};
use glam::DVec3;
use phalanx::{Scene, targets};
use phalanx_hand::{Dof, JOINTS, Pose};

use super::ground::Ground;

/// The poses and joints of a test set.
pub(crate) struct Truth {
    /// 28 × T.
    pub(crate) poses: Mat<f64>,
    /// Of each sample, in the world, mm.
    joints: Vec<[DVec3; JOINTS]>,
}

impl Truth {
    /// Of scenes before a rig. Where its cameras have moved, its calibration still says where
    /// joints are.
    pub(crate) fn of(scenes: impl Iterator<Item = Scene>, ground: &Ground) -> Self {
        let rest = ground.rig.volume.rest_frame();
        let (poses, joints): (Vec<Pose>, Vec<_>) =
            scenes.map(|scene| (scene.pose, scene.hand.pose(&scene.pose, &rest).joints)).unzip();
        Self { poses: targets(&poses), joints }
    }

    /// Mean distance of the estimated hand's 21 joints from the true ones', mm. The estimated hand
    /// is the one that was learnt from.
    pub(crate) fn joint_error_mm(&self, estimates: MatRef<'_, f64>, ground: &Ground) -> f64 {
        let rest = ground.rig.volume.rest_frame();
        let error = |(sample, truth): (usize, &[DVec3; JOINTS])| -> f64 {
            let pose = Pose(std::array::from_fn(|dof| estimates[(dof, sample)]));
            let joints = ground.hand.pose(&pose, &rest).joints;
            joints.iter().zip(truth).map(|(a, b)| a.distance(*b)).sum()
        };
        let total: f64 = self.joints.iter().enumerate().map(error).sum();
        total / (self.joints.len() * JOINTS) as f64
    }
}

/// Mean over those angles of how far a pose is from the truth, degrees.
pub(crate) fn mean_error_deg(pose: &Pose, truth: &Pose) -> f64 {
    let angles = active_angles();
    let off = angles.iter().map(|&dof| (pose[dof] - truth[dof]).abs());
    off.sum::<f64>().to_degrees() / angles.len() as f64
}

/// The angles over which errors are averaged: those of the paper's sets.
pub(crate) fn active_angles() -> Vec<Dof> {
    Dof::ALL.into_iter().filter(|&dof| dof.is_internal() || dof == Dof::ThetaZ).collect()
}
