//! Poses of the real hand: estimated, placed, refined, and the hand calibrated.

use anyhow::{Context, Result};
use phalanx::{
    Estimate, Estimator, Framing, Observation, Preset, Progress, Refiner, Training, Workspace,
};
use phalanx_camera::Rig;
use phalanx_hand::{Digit, Dof, HandShape, Pose};
use phalanx_refine::{
    BundleAdjustment, BundleFrame, PoseFit, PoseFitSettings, PosePrior, ShapePrior,
    SilhouetteObservation,
};
use rayon::prelude::*;

use super::Seen;
use crate::data::sets;
use crate::recipes::trained;

/// Frames that the hand is calibrated on, evenly spaced.
const CALIBRATED_ON: usize = 20;

/// How far the hand's size and its proportions may be from the mean's, as logarithms. The size
/// takes up that the calibration's unit is known roughly only.
const HAND: ShapePrior = ShapePrior { size: 0.2, thickness: 0.06, each: 0.06 };

/// Standard deviation of a border's place in photographs, px: more than in drawn pictures, and over
/// whole stretches of the border, so that what is seen outweighs what hands do less.
const NOISE_PX: f64 = 2.0;

/// How far an angle moves from one frame to the next, standard deviation.
const MOTION_DEG: f64 = 10.0;

/// How often what is known of a frame is handed on through all others.
const SWEEPS: usize = 2;

/// An estimator for the rig, and what its estimates are refined with.
pub(super) struct Learnt {
    pub(super) estimator: Estimator,
    refiner: Refiner,
}

/// A frame ready for refinement.
#[derive(Clone)]
pub(super) struct Start {
    pub(super) estimate: Estimate,
    evidence: Vec<SilhouetteObservation>,
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
    let refiner = Refiner::new(rig, hand, &set.poses, PoseFitSettings::of_noise(NOISE_PX))?;
    Ok(Learnt { estimator: trained(&training, &set, None, progress)?.estimator, refiner })
}

impl Learnt {
    /// The estimate of a frame, and what is to be refined.
    pub(super) fn start(&self, seen: &Seen, workspace: &mut Workspace) -> Result<Start> {
        let observation = Observation::through_windows(&seen.silhouettes, &seen.windows);
        let estimate = self.estimator.estimate_observation(observation, workspace)?;
        let evidence = self.refiner.evidence_of(&estimate.observation)?;
        // How hands are before a camera, and no more: starts of every posture are compared by it.
        let open = estimate.std.map(|std| std.map(|_| f64::INFINITY));
        let prior = self.refiner.prior(&estimate.pose, &open)?;
        Ok(Start { estimate, evidence, prior })
    }

    /// The hand in some of the frames, from where they were refined to.
    pub(super) fn calibrate(&self, starts: &[Start], refined: &[PoseFit]) -> Result<HandShape> {
        let step = starts.len().div_ceil(CALIBRATED_ON).max(1);
        let frame = |(start, refined): (&Start, &PoseFit)| -> Result<BundleFrame> {
            let Start { evidence, prior, .. } = start.clone();
            Ok(BundleFrame {
                observations: evidence,
                landmarks: Vec::new(),
                start: refined.pose,
                prior,
            })
        };
        let frames: Vec<BundleFrame> =
            starts.iter().zip(refined).step_by(step).map(frame).collect::<Result<_>>()?;
        let calibration = BundleAdjustment { hand: HAND, ..BundleAdjustment::default() };
        Ok(calibration.run(self.refiner.hand(), self.refiner.rest(), &frames)?.hand)
    }

    /// All frames refined with a hand: each alone from some poses, the best of which is kept, then each
    /// between the frame before it and the frame after.
    pub(super) fn refine(
        &self,
        hand: &HandShape,
        starts: &[Start],
        poses: impl Fn(usize) -> Vec<Pose> + Sync,
    ) -> Result<Vec<PoseFit>> {
        let alone = |k: usize, start: &Start| -> Result<PoseFit> {
            let mean = self.from(hand, start, start.estimate.pose, &start.prior)?;
            poses(k).into_iter().try_fold(mean, |best, pose| {
                Ok(better(best, self.from(hand, start, pose, &start.prior)?))
            })
        };
        let mut refined: Vec<PoseFit> = starts
            .par_iter()
            .enumerate()
            .map(|(k, start)| alone(k, start))
            .collect::<Result<_>>()?;
        for _ in 0..SWEEPS {
            for k in (0..starts.len()).chain((0..starts.len()).rev()) {
                refined[k] = self.between(hand, &starts[k], k, &refined)?;
            }
        }
        Ok(refined)
    }

    /// A frame refined once more beside its neighbours, which the hand is not far from.
    fn between(
        &self,
        hand: &HandShape,
        start: &Start,
        frame: usize,
        refined: &[PoseFit],
    ) -> Result<PoseFit> {
        let within =
            |dof: Dof| if dof.is_internal() { MOTION_DEG.to_radians() } else { f64::INFINITY };
        let moves = Dof::ALL.map(within);
        let mut prior = start.prior.clone();
        let around = frame.saturating_sub(1)..refined.len().min(frame + 2);
        for neighbour in around.clone().filter(|&other| other != frame) {
            prior = prior.product(&PosePrior::independent(refined[neighbour].pose, &moves)?)?;
        }
        let from = |fit: &PoseFit| self.from(hand, start, fit.pose, &prior);
        let tried: Vec<PoseFit> = refined[around].par_iter().map(from).collect::<Result<_>>()?;
        tried.into_iter().reduce(better).context("a frame is beside itself")
    }

    /// A frame refined from a pose.
    fn from(
        &self,
        hand: &HandShape,
        start: &Start,
        pose: Pose,
        prior: &PosePrior,
    ) -> Result<PoseFit> {
        let rest = self.refiner.rest();
        Ok(self.refiner.refinement().fit(hand, rest, &start.evidence, &pose, prior)?)
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

/// The more plausible of two.
fn better(one: PoseFit, other: PoseFit) -> PoseFit {
    if other.energy < one.energy { other } else { one }
}

/// How long the hand is from the wrist to the middle finger's tip, mm.
pub(super) fn length_mm(hand: &HandShape) -> f64 {
    let joints = hand.pose(&Pose::REST, &glam::DAffine3::IDENTITY).joints;
    joints[12].distance(joints[0])
}

/// Means over frames of the least overlap of a frame's views, and the share of frames in which all
/// views reach a goal.
pub(super) fn overlaps(fitted: &[PoseFit], goal: f64) -> (f64, f64) {
    let least = |fit: &PoseFit| fit.ious.iter().copied().fold(1.0, f64::min);
    let count = fitted.len().max(1) as f64;
    let mean = fitted.iter().map(least).sum::<f64>() / count;
    let reached = fitted.iter().filter(|fit| least(fit) >= goal).count();
    (mean, reached as f64 / count)
}
