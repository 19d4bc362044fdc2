//! Poses of the real hand: estimated, placed, refined, and the hand calibrated.

use anyhow::Result;
use phalanx::{Estimate, Estimator, Framing, Progress, Refiner, Shard, Training, Workspace};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use phalanx_refine::{
    Calibration, CalibrationFrame, Evidence, HandDoubt, PosePrior, Refined, Refinement,
};
use rayon::prelude::*;

use super::Seen;
use crate::global_pose::start;
use crate::held_out::method::nystrom;
use crate::sets;

/// Frames that the hand is calibrated on, evenly spaced.
const CALIBRATED_ON: usize = 20;

/// How far the hand's size and its proportions may be from the mean's, as logarithms. The size
/// takes up that the calibration's unit is known roughly only.
const HAND: HandDoubt = HandDoubt { size: 0.2, each: 0.06 };

/// An estimator for the rig, and what its estimates are refined with.
pub(super) struct Learnt {
    pub(super) estimator: Estimator,
    refiner: Refiner,
}

/// A frame ready for refinement.
pub(super) struct Start {
    pub(super) estimate: Estimate,
    evidence: Vec<Evidence>,
    prior: PosePrior,
}

/// What came of a frame.
pub(super) struct Fitted {
    pub(super) start: Pose,
    pub(super) refined: Refined,
}

pub(super) fn learn(
    rig: &Rig,
    hand: &HandShape,
    samples: usize,
    progress: &dyn Progress,
) -> Result<Learnt> {
    let training =
        Training { framing: Framing::Window, regressor: nystrom(), ..Training::default() };
    let set = sets::loosely_placed(rig, hand, samples);
    let part = training.shard(rig, hand, &set, Shard::WHOLE, progress)?;
    if part.left_out() > 0 {
        eprintln!("{} of {samples} samples could not be described", part.left_out());
    }
    let refiner = Refiner::new(rig, hand, &set.poses, Refinement::default())?;
    Ok(Learnt { estimator: part.finish()?, refiner })
}

impl Learnt {
    /// The estimate of a frame, and what is to be refined.
    pub(super) fn start(&self, seen: &Seen, workspace: &mut Workspace) -> Result<Start> {
        let estimate = self.estimator.estimate_silhouettes(&seen.silhouettes, workspace)?;
        let estimate = start(&self.estimator, &estimate, &seen.windows)?;
        let pairs = seen.windows.iter().zip(&seen.silhouettes);
        let evidence = pairs.map(|(window, silhouette)| window.evidence(silhouette));
        let evidence = evidence.collect::<Result<_, _>>()?;
        let prior = self.refiner.prior(&estimate.pose, &estimate.std)?;
        Ok(Start { estimate, evidence, prior })
    }

    /// The hand in some of the frames.
    pub(super) fn calibrate(&self, starts: &[Start]) -> Result<HandShape> {
        let step = starts.len().div_ceil(CALIBRATED_ON).max(1);
        let frame = |start: &Start| CalibrationFrame {
            evidence: start.evidence.clone(),
            start: *start.prior.mean(),
            prior: start.prior.clone(),
        };
        let frames: Vec<CalibrationFrame> = starts.iter().step_by(step).map(frame).collect();
        let calibration = Calibration { hand: HAND, ..Calibration::default() };
        let given = self.refiner.hand();
        Ok(calibration.run(given, self.refiner.rest(), &frames)?.hand)
    }

    /// All frames refined with a hand.
    pub(super) fn refine(&self, hand: &HandShape, starts: &[Start]) -> Result<Vec<Fitted>> {
        let refinement = Refinement::default();
        let rest = self.refiner.rest();
        let refine = |start: &Start| -> Result<Fitted> {
            let mean = *start.prior.mean();
            let refined = refinement.run(hand, rest, &start.evidence, &mean, &start.prior)?;
            Ok(Fitted { start: start.estimate.pose, refined })
        };
        starts.par_iter().map(refine).collect()
    }
}

/// How long the hand is from the wrist to the middle finger's tip, mm.
pub(super) fn length_mm(hand: &HandShape) -> f64 {
    let joints = hand.pose(&Pose::REST, &glam::DAffine3::IDENTITY).joints;
    joints[12].distance(joints[0])
}

/// Means over frames of the least overlap of a frame's views, and the share of frames in which all
/// views reach a goal.
pub(super) fn overlaps(fitted: &[Fitted], goal: f64) -> (f64, f64) {
    let least = |fit: &Fitted| fit.refined.overlaps.iter().copied().fold(1.0, f64::min);
    let count = fitted.len().max(1) as f64;
    let mean = fitted.iter().map(least).sum::<f64>() / count;
    let reached = fitted.iter().filter(|fit| least(fit) >= goal).count();
    (mean, reached as f64 / count)
}
