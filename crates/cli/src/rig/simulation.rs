//! What to expect of a rig, by simulation: hands that are drawn in the working volume, seen by the rig's cameras,
//! and fitted.

use anyhow::{Result, ensure};
use glam::DVec3;
use phalanx::{
    Augmentation, Framing, PoseSource, Progress, Proportions, SceneSampler, SceneSource, TakeFrame,
    TakeSettings, draw_mask, fit_take,
};
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose};
use serde::Serialize;

/// Moments that are drawn.
const MOMENTS: usize = 48;

/// So many moments it is from one random pose to the next: a recording shows a hand that moves, and each of its
/// frames is fitted in the light of its neighbours. Poses that have nothing to do with each other are fitted
/// worse than any recording's.
const STEPS: usize = 6;

/// Angles whose place does not depend on where the hand is: of the digits and the wrist.
const ANGLES: usize = Dof::INTERNAL + 2;

#[derive(Serialize)]
pub(crate) struct Simulation {
    pub(crate) moments: usize,
    /// Those whose fit nothing speaks against.
    pub(crate) trusted: usize,
    /// Mean distance of the joints from where they were drawn, mm, over the trusted fits.
    pub(crate) joints_mm: f64,
    pub(crate) angles: Vec<Angle>,
}

/// One angle over the trusted fits, degrees.
#[derive(Serialize)]
pub(crate) struct Angle {
    pub(crate) name: &'static str,
    /// The mean of the standard deviations that come with the fits.
    pub(crate) std_deg: f64,
    /// The mean absolute error.
    pub(crate) error_deg: f64,
}

/// Draws a mean adult hand that goes from one random pose to the next, as sharp as silhouettes can be, and fits
/// the moments together, as `phalanx track` does, with its proportions known.
pub(crate) fn simulate(rig: &Rig, progress: &dyn Progress) -> Result<Simulation> {
    let (hand, rest) = (HandShape::adult(), rig.volume.rest_frame());
    let poses = motion(rig, &hand);
    // What a camera does not show is missing.
    let masks = |pose: &Pose| {
        rig.cameras.iter().map(|camera| draw_mask(camera, &hand, pose, &rest).ok()).collect()
    };
    let frames: Vec<TakeFrame> =
        poses.iter().map(|pose| TakeFrame::of_masks(masks(pose))).collect();
    let settings = TakeSettings { hand: hand.clone(), proportions: Proportions::Given };
    let fit = fit_take(&rig.cameras, &frames, &settings, progress)?;
    let trusted: Vec<_> =
        fit.frames.iter().zip(&poses).filter(|(frame, _)| frame.doubts.is_empty()).collect();
    ensure!(!trusted.is_empty(), "none of {MOMENTS} drawn hands is fitted without a doubt");
    let mean = |sum: f64| sum / trusted.len() as f64;
    let angle = |dof: Dof| Angle {
        name: dof.name(),
        std_deg: mean(trusted.iter().map(|(frame, _)| frame.std[dof.index()]).sum()).to_degrees(),
        error_deg: mean(
            trusted.iter().map(|(frame, pose)| (frame.pose[dof] - pose[dof]).abs()).sum(),
        )
        .to_degrees(),
    };
    let distance = |(frame, pose): &(&phalanx::FrameFit, &Pose)| {
        let drawn: [DVec3; 21] = hand.pose(pose, &rest).joints;
        let distances =
            frame.joints.iter().zip(drawn).map(|(fitted, drawn)| fitted.distance(drawn));
        distances.sum::<f64>() / 21.0
    };
    Ok(Simulation {
        moments: MOMENTS,
        trusted: trusted.len(),
        joints_mm: mean(trusted.iter().map(distance).sum()),
        angles: Dof::ALL.into_iter().take(ANGLES).map(angle).collect(),
    })
}

/// The poses of a hand that goes evenly from one random pose to the next.
fn motion(rig: &Rig, hand: &HandShape) -> Vec<Pose> {
    let sampler = SceneSampler {
        augmentation: Augmentation::NONE,
        ..SceneSampler::new(PoseSource::for_framing(Framing::Window))
    };
    let scenes = sampler.scenes(rig, hand, MOMENTS.div_ceil(STEPS) + 1);
    let pose = |moment: usize| {
        let [from, to] = [0, 1].map(|next| scenes.scene(moment / STEPS + next).pose.0);
        let share = (moment % STEPS) as f64 / STEPS as f64;
        Pose(std::array::from_fn(|dof| from[dof] + share * (to[dof] - from[dof])))
    };
    (0..MOMENTS).map(pose).collect()
}
