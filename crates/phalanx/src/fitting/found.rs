//! A pose that was found, and what it was found with.

use glam::DAffine3;
use phalanx_camera::Camera;
use phalanx_hand::{HandShape, Pose};
use phalanx_refine::PoseFit;

use super::misfit;
use super::points::CameraPoints;
use super::starts;
use crate::localize::HandCrop;

/// A pose found.
#[derive(Debug, Clone)]
pub(super) struct Found {
    /// The frame of the hand at rest that the pose is in.
    pub(super) rest: DAffine3,
    pub(super) refined: PoseFit,
    /// What each view sees.
    pub(super) crops: Vec<Option<HandCrop>>,
    /// What a detector saw, camera by camera.
    pub(super) points: Vec<Option<CameraPoints>>,
    /// The views that disagree with the others, in this frame or in the whole take, and are left out: the crops, then the
    /// points.
    pub(super) left_out: Vec<bool>,
    /// How likely it is that the hand is at the arm's other end, by what hangs together with it.
    pub(super) backwards: f64,
    /// How far the views together are from agreeing with it.
    pub(super) misfit: f64,
}

impl Found {
    /// A pose without anything seen.
    #[cfg(test)]
    pub(super) fn at(pose: Pose, misfit: f64) -> Self {
        let refined = PoseFit {
            pose,
            covariance: Vec::new(),
            ious: Vec::new(),
            unexplained: Vec::new(),
            landmarks_unexplained: Vec::new(),
            boundary_rms_px: 0.0,
            nuisance: None,
            energy: 0.0,
            converged: true,
            steps: 0,
        };
        let (crops, points, left_out) = (Vec::new(), Vec::new(), Vec::new());
        let backwards = 0.0;
        Self { rest: DAffine3::IDENTITY, refined, crops, points, left_out, backwards, misfit }
    }

    /// The hand's frame: its origin at the wrist, z along the forearm.
    pub(super) fn frame(&self, hand: &HandShape) -> DAffine3 {
        starts::frame_at(&self.refined.pose, &self.rest, hand)
    }

    /// The camera, where there is only one and it shows anything.
    pub(super) fn only_camera(&self) -> Option<&Camera> {
        match &self.crops[..] {
            [only] => only.as_ref().map(|crop| &crop.camera),
            _ => None,
        }
    }

    /// Whether a camera's points are left out.
    pub(super) fn left_out_points(&self, camera: usize) -> bool {
        self.left_out[self.crops.len() + camera]
    }

    /// Of how many cameras something is used.
    pub(super) fn cameras_used(&self) -> usize {
        let is_used = |&camera: &usize| {
            self.crops[camera].is_some() && !self.left_out[camera]
                || self.points[camera].is_some() && !self.left_out_points(camera)
        };
        (0..self.crops.len()).filter(is_used).count()
    }

    /// How far all views are from agreeing with it; those that are left out explain nothing.
    pub(super) fn misfit_of_all_views(&self) -> f64 {
        let none_left_out = vec![false; self.left_out.len()];
        let views = views_used(&self.crops, &self.points, &none_left_out);
        misfit::of_fit(&self.refined, views) + self.backwards
    }

    /// The pose in another frame of rest.
    pub(super) fn pose_in(&self, rest: &DAffine3, hand: &HandShape) -> Pose {
        starts::in_frame(&self.refined.pose, &self.rest, rest, hand)
    }
}

/// How many views that are not left out should show the hand: all masks that there are, if any shows it, and
/// all points.
pub(super) fn views_used(
    crops: &[Option<HandCrop>],
    points: &[Option<CameraPoints>],
    left_out: &[bool],
) -> usize {
    let (crops_out, points_out) = left_out.split_at(crops.len());
    let points = points.iter().zip(points_out);
    let with_points = points.filter(|(points, left_out)| points.is_some() && !**left_out).count();
    if with_points > 0 && crops.iter().all(Option::is_none) {
        return with_points;
    }
    crops_out.iter().filter(|left_out| !**left_out).count() + with_points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_that_is_left_out_is_not_explained() {
        let found = Found::at(Pose::REST, 0.0);
        let refined = PoseFit { ious: vec![0.95], unexplained: vec![0.02], ..found.refined };
        let of = |left_out: &[bool]| {
            let (crops, left_out) = (vec![None; left_out.len()], left_out.to_vec());
            Found { refined: refined.clone(), crops, left_out, ..Found::at(Pose::REST, 0.0) }
        };
        let [one, two] = [of(&[false]), of(&[false, true])].map(|own| own.misfit_of_all_views());
        assert!(one < 0.2 && two > 1.0, "{one} {two}");
        assert!(two < misfit::of_views(&[], 2));
    }
}
