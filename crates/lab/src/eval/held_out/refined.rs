//! The default preset's estimates, refined: with the hand as given, and after calibrating it.

use anyhow::Result;
use phalanx::{Estimate, Estimator, Progress, Refiner, SceneDescriber, SceneSource, Workspace};
use phalanx_hand::Pose;
use phalanx_refine::{
    BundleAdjustment, BundleFrame, CameraMotion, ExtrinsicsPrior, NuisanceParameters,
    PoseFitSettings, ShapePrior,
};
use phalanx_segmentation::Silhouette;
use rayon::prelude::*;

use super::ground::Ground;
use crate::data::sets::{self, Augment, Set};

/// Poses that tell how angles go together.
const POSTURES: usize = 2000;
/// Frames from which each hand is calibrated.
const CALIBRATION_FRAMES: usize = 20;

/// How far a calibrated hand may still be from the true one.
const CALIBRATED: ShapePrior = ShapePrior { size: 0.005, thickness: 0.005, each: 0.02 };

/// Where refinement starts.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Starts {
    Estimate,
    /// Hypotheses about it too, if need be.
    Hypotheses,
}

/// Refines with the hand as given.
pub(crate) fn refiner(
    estimator: &Estimator,
    ground: &Ground,
    refinement: PoseFitSettings,
) -> Result<Refiner> {
    let postures = sets::fresh(estimator.rig(), &ground.hand, POSTURES, Augment::No).poses;
    Ok(Refiner::new(estimator.rig(), &ground.hand, &postures, refinement)?)
}

/// The refined pose of one frame.
pub(crate) fn refine(
    estimator: &Estimator,
    refiner: &Refiner,
    estimate: Estimate,
    starts: Starts,
) -> Result<Pose> {
    Ok(match starts {
        Starts::Estimate => {
            refiner.refine(&refiner.evidence_of(&estimate.observation)?, &estimate)?.pose
        }
        Starts::Hypotheses => refiner.refine_estimate(estimator, estimate)?.fit.pose,
    })
}

/// Calibrates each hand of a test from other frames of it; a refiner for each.
pub(crate) fn own_hands(
    estimator: &Estimator,
    refiner: &Refiner,
    views: &[usize],
    set: &Set<'_>,
    ground: &Ground,
    progress: &dyn Progress,
) -> Result<Vec<Refiner>> {
    let others = set.other_motion();
    let describer = SceneDescriber::new(&ground.rig, ground.rule)?;
    let hands = set.hands();
    progress.begin(&format!("calibrate the hands of {}", set.name), hands);
    let calibrate = |hand: usize| -> Result<Refiner> {
        let mut describer = describer.clone();
        let rounds = others.count() / hands / CALIBRATION_FRAMES;
        let mut frames = Vec::with_capacity(CALIBRATION_FRAMES);
        for k in 0..CALIBRATION_FRAMES {
            let scene = others.scene(hand + hands * rounds * k);
            let all: Vec<Silhouette> = describer.silhouettes(&scene)?.cloned().collect();
            frames.push(views.iter().map(|&view| all[view].clone()).collect());
        }
        // In these tests cameras stand elsewhere in every frame.
        let own = calibrated(estimator, refiner, &frames, CameraMotion::PerFrame)?;
        progress.step();
        Ok(own)
    };
    (0..hands).into_par_iter().map(calibrate).collect()
}

/// A refiner for the hand that all of some frames show.
fn calibrated(
    estimator: &Estimator,
    refiner: &Refiner,
    frames: &[Vec<Silhouette>],
    motion: CameraMotion,
) -> Result<Refiner> {
    let mut workspace = Workspace::default();
    let frame = |seen: &Vec<Silhouette>| -> Result<BundleFrame> {
        let estimate = estimator.estimate_silhouettes(seen, &mut workspace)?;
        Ok(refiner.frame(&estimate)?)
    };
    let frames = frames.iter().map(frame).collect::<Result<Vec<_>>>()?;
    let nuisance = NuisanceParameters::default();
    let cameras = nuisance.cameras.map(|cameras| ExtrinsicsPrior { motion, ..cameras });
    let calibration = BundleAdjustment { cameras, ..BundleAdjustment::default() };
    let own = refiner.calibrate(&calibration, &frames)?.hand;
    let refinement = PoseFitSettings {
        nuisance: Some(NuisanceParameters { hand: Some(CALIBRATED), ..nuisance }),
        ..refiner.refinement().clone()
    };
    Ok(refiner.with_hand(&own)?.with_refinement(refinement))
}

/// A refiner for the one hand that silhouettes from elsewhere show, through cameras that stand still;
/// calibrated from some of them, evenly spaced, without their truth.
pub(crate) fn own_hand_of_masks(
    estimator: &Estimator,
    refiner: &Refiner,
    frames: &[Vec<Silhouette>],
) -> Result<Refiner> {
    let count = frames.len().min(CALIBRATION_FRAMES);
    let some: Vec<_> = (0..count).map(|k| frames[k * frames.len() / count].clone()).collect();
    calibrated(estimator, refiner, &some, CameraMotion::Static)
}
