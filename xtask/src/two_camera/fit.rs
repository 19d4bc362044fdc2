//! Poses of the real hand: estimated, placed, refined, and the hand calibrated.

use anyhow::Result;
use phalanx::{
    Estimate, Estimator, Framing, Preset, Progress, Refiner, Shard, Training, Workspace,
};
use phalanx_camera::Rig;
use phalanx_hand::{Digit, HandShape, Pose};
use phalanx_refine::{
    Calibration, CalibrationFrame, Evidence, HandDoubt, PosePrior, Refined, Refinement,
};
use rayon::prelude::*;

use super::Seen;
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

/// Learns from drawn hands anywhere before the cameras.
pub(super) fn learn(
    rig: &Rig,
    hand: &HandShape,
    samples: usize,
    progress: &dyn Progress,
) -> Result<Learnt> {
    let training = Training { framing: Framing::Window, ..Preset::Fast.training() };
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
        let estimate = self.estimator.place(estimate, &seen.windows)?;
        let pairs = seen.windows.iter().zip(&seen.silhouettes);
        let evidence = pairs.map(|(window, silhouette)| window.evidence(silhouette));
        let evidence = evidence.collect::<Result<_, _>>()?;
        let prior = self.refiner.prior(&estimate.pose, &estimate.std)?;
        Ok(Start { estimate, evidence, prior })
    }

    /// The hand in some of the frames, from where they were refined to.
    pub(super) fn calibrate(&self, starts: &[Start], refined: &[Refined]) -> Result<HandShape> {
        let step = starts.len().div_ceil(CALIBRATED_ON).max(1);
        let frame = |(start, refined): (&Start, &Refined)| -> Result<CalibrationFrame> {
            let prior = start.prior.about(refined.pose)?;
            Ok(CalibrationFrame { evidence: start.evidence.clone(), start: refined.pose, prior })
        };
        let frames: Vec<CalibrationFrame> =
            starts.iter().zip(refined).step_by(step).map(frame).collect::<Result<_>>()?;
        let calibration = Calibration { hand: HAND, ..Calibration::default() };
        Ok(calibration.run(self.refiner.hand(), self.refiner.rest(), &frames)?.hand)
    }

    /// All frames refined with a hand: each from some poses, the best of which is kept, then from the
    /// frame before it and from the frame after.
    pub(super) fn refine(
        &self,
        hand: &HandShape,
        starts: &[Start],
        poses: impl Fn(usize) -> Vec<Pose> + Sync,
    ) -> Result<Vec<Refined>> {
        let alone = |k: usize, start: &Start| -> Result<Refined> {
            let mean = self.from(hand, start, *start.prior.mean())?;
            poses(k)
                .into_iter()
                .try_fold(mean, |best, pose| Ok(better(best, self.from(hand, start, pose)?)))
        };
        let mut refined: Vec<Refined> = starts
            .par_iter()
            .enumerate()
            .map(|(k, start)| alone(k, start))
            .collect::<Result<_>>()?;
        let forwards = (1..starts.len()).map(|k| (k - 1, k));
        let backwards = (1..starts.len()).rev().map(|k| (k, k - 1));
        for (known, next) in forwards.chain(backwards) {
            let followed = self.from(hand, &starts[next], refined[known].pose)?;
            refined[next] = better(refined[next].clone(), followed);
        }
        Ok(refined)
    }

    /// A frame refined from a pose, which takes the place of the estimate.
    fn from(&self, hand: &HandShape, start: &Start, pose: Pose) -> Result<Refined> {
        let prior = start.prior.about(pose)?;
        let rest = self.refiner.rest();
        Ok(Refinement::default().run(hand, rest, &start.evidence, &pose, &prior)?)
    }
}

/// A pose with every finger either straight or folded into the palm.
pub(super) fn postures(pose: &Pose) -> Vec<Pose> {
    const FOLDED_DEG: [f64; 4] = [0.0, 60.0, 85.0, 50.0];
    let posture = |folded: usize| {
        let mut pose = *pose;
        for (k, finger) in Digit::FINGERS.into_iter().enumerate() {
            let share = f64::from(u8::from(folded >> k & 1 == 1));
            for (dof, degrees) in finger.dofs().into_iter().zip(FOLDED_DEG) {
                pose[dof] = (share * degrees).to_radians();
            }
        }
        pose
    };
    (0..1 << Digit::FINGERS.len()).map(posture).collect()
}

/// That of two which covers more of what was seen, on average over the views.
fn better(one: Refined, other: Refined) -> Refined {
    let sum = |refined: &Refined| refined.overlaps.iter().sum::<f64>();
    if sum(&other) > sum(&one) { other } else { one }
}

/// How long the hand is from the wrist to the middle finger's tip, mm.
pub(super) fn length_mm(hand: &HandShape) -> f64 {
    let joints = hand.pose(&Pose::REST, &glam::DAffine3::IDENTITY).joints;
    joints[12].distance(joints[0])
}

/// Means over frames of the least overlap of a frame's views, and the share of frames in which all
/// views reach a goal.
pub(super) fn overlaps(fitted: &[Refined], goal: f64) -> (f64, f64) {
    let least = |fit: &Refined| fit.overlaps.iter().copied().fold(1.0, f64::min);
    let count = fitted.len().max(1) as f64;
    let mean = fitted.iter().map(least).sum::<f64>() / count;
    let reached = fitted.iter().filter(|fit| least(fit) >= goal).count();
    (mean, reached as f64 / count)
}
