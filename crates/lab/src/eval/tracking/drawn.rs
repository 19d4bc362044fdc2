//! Drawn recordings of a hand before three cameras: photographs with a sensor's noise, cut out by the skin model.

use anyhow::Result;
use glam::DAffine3;
use phalanx::TakeFrame;
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{Digit, Dof, HandShape, Pose};
use phalanx_render::{Appearance, Renderer};
use phalanx_segmentation::{AdaptedSkin, Mask, SkinModel};
use rayon::prelude::*;

/// Frames a second, as of webcams.
pub(super) const RATE: f64 = 30.0;

/// The photographs' size, px.
const SIZE: (u32, u32) = (320, 240);

/// The greatest bend of the fingers' joints from the knuckle outwards, radians: a loose fist. It is reached at
/// the same speed by proximal joints as by hands that grasp.
const BEND: [f64; 3] = [1.2, 1.7, 1.1];

/// Where each finger is behind the one before it, as a share of a turn.
const BEHIND: f64 = 0.08;

/// One hand before cameras.
pub(super) struct Studio {
    pub(super) cameras: Vec<Camera>,
    pub(super) hand: HandShape,
    rest: DAffine3,
    skin: SkinModel,
    appearance: Appearance,
}

impl Studio {
    pub(super) fn new(rig: &Rig, hand: &HandShape) -> Self {
        let small =
            |camera: &Camera| camera.with_intrinsics(camera.intrinsics.resized(SIZE.0, SIZE.1));
        Self {
            cameras: rig.cameras.iter().map(small).collect(),
            hand: hand.clone(),
            rest: rig.volume.rest_frame(),
            skin: SkinModel::builtin(),
            appearance: Appearance::default(),
        }
    }

    /// The hand's joints in the world, mm.
    pub(super) fn joints(&self, pose: &Pose) -> Vec<glam::DVec3> {
        self.hand.pose(pose, &self.rest).joints.to_vec()
    }

    /// What the cameras see of each pose. No two frames have the same noise.
    pub(super) fn frames(&self, poses: &[Pose]) -> Result<Vec<TakeFrame>> {
        (0..poses.len()).into_par_iter().map(|number| self.frame(&poses[number], number)).collect()
    }

    fn frame(&self, pose: &Pose, number: usize) -> Result<TakeFrame> {
        let solids = self.hand.pose(pose, &self.rest).primitives;
        let mask = |(view, camera): (usize, &Camera)| -> Result<Option<Mask>> {
            let seed = (number * self.cameras.len() + view) as u64;
            let photograph = Renderer::new(camera)?.shade(&solids, &self.appearance, seed)?;
            Ok(Some(AdaptedSkin::new(&self.skin, &photograph).segment(&photograph)))
        };
        let masks = self.cameras.iter().enumerate().map(mask).collect::<Result<_>>()?;
        Ok(TakeFrame::of_masks(masks).at(number as f64 / RATE))
    }
}

/// Fingers that close and open one after the other, the proximal joints at most at so many degrees a second.
pub(super) fn closing(speed_deg: f64, count: usize) -> Vec<Pose> {
    // Half of the bend times the angular frequency is the greatest speed.
    let frequency = 2.0 * speed_deg.to_radians() / BEND[1];
    (0..count).map(|number| posture(frequency * number as f64 / RATE)).collect()
}

fn posture(phase: f64) -> Pose {
    let mut pose = Pose::REST;
    for (finger, digit) in Digit::FINGERS.into_iter().enumerate() {
        let share = 0.5 - 0.5 * (phase - std::f64::consts::TAU * BEHIND * finger as f64).cos();
        let [_, joints @ ..] = digit.dofs();
        joints.into_iter().zip(BEND).for_each(|(dof, bend)| pose[dof] = share * bend);
    }
    // Halfway between the turns that the desk's cameras are made for.
    pose[Dof::ThetaZ] = std::f64::consts::FRAC_PI_4;
    pose
}
