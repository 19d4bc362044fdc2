//! The hand's proportions, from a take.

use glam::DAffine3;
use phalanx_hand::HandShape;
use phalanx_refine::{BundleAdjustment, BundleFrame, ShapePrior};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::consensus::evenly;
use super::found::Found;
use super::frame_fit::{FrameFitter, Seen};
use super::views;
use crate::error::{Error, Result};

/// Frames that a hand is learnt from first, and as many that it is tested on.
const LEARNT_FROM: usize = 16;

/// How far hands differ from the mean adult's: the logarithm of the size so that hands of 130 to 215 mm
/// are within two deviations of their middle, of how thick all of it is by some per cent, and of every bone and radius by as
/// much again.
pub(super) const POPULATION: ShapePrior = ShapePrior { size: 0.126, thickness: 0.06, each: 0.06 };

/// A hand, and how well each of its proportions is known (standard deviations of logarithms).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct KnownHand {
    pub(super) shape: HandShape,
    pub(super) std: Vec<f64>,
}

impl KnownHand {
    /// A hand of which no more is known than that it is somebody's.
    pub(super) fn anyone(shape: &HandShape) -> Self {
        Self { shape: shape.clone(), std: POPULATION.deviations(shape) }
    }

    /// Whether more is known of it than that it is somebody's.
    pub(super) fn is_learnt(&self) -> bool {
        self.std != POPULATION.deviations(&self.shape)
    }
}

/// What borders tell of a hand's proportions.
#[derive(Debug, Clone, Copy)]
pub(super) struct HandEvidence {
    /// How many independent places one of the best view's border counts for.
    pub(super) independent: f64,
    /// Which share of a border's variance is the same in every frame.
    pub(super) persistent: f64,
}

/// The hand learnt from some frames, beginning with the mean hand, if one that is learnt from half of them fits the
/// other half better than the mean hand does; else `None`. Frames whose views contradict their poses tell nothing. A place
/// of the best view's border tells as much as `border.independent` places that err alone, and all frames as much as those
/// would that do not err as others do: so well is the hand known.
pub(super) fn learn(
    mean: &HandShape,
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    rest: &DAffine3,
    border: HandEvidence,
) -> Result<Option<KnownHand>> {
    let found = telling(fitter, found)?;
    let frame = |found: &Found| {
        let frame = found.frame(fitter.hand);
        let evidence = fitter.seen(&found.crops, &found.points, &found.left_out, &frame);
        let start = found.pose_in(rest, fitter.hand);
        let Seen { silhouettes: observations, landmarks } = evidence;
        BundleFrame { observations, landmarks, start, prior: fitter.prior.clone() }
    };
    let chosen = evenly(found.len(), 2 * LEARNT_FROM);
    let frames = chosen.iter().map(|&k| frame(found[k]));
    let frames: Vec<BundleFrame> = frames.filter(|frame| !frame.evidence().is_empty()).collect();
    let (seen, held) = alternating(&frames);
    if held.is_empty() {
        return Ok(None);
    }
    let refinement = fitter.refinement.clone();
    // Poses are fitted as if each place of the best view's border told as much as one that errs alone. Of borders that
    // tell less, as much more is known of hands beside them.
    let beside = border.independent.min(1.0).sqrt();
    let hand = ShapePrior {
        size: POPULATION.size * beside,
        thickness: POPULATION.thickness * beside,
        each: POPULATION.each * beside,
    };
    let calibration = BundleAdjustment { pose_fit: refinement, hand, cameras: None };
    let learnt_from = |frames: &[BundleFrame]| match calibration.run(mean, rest, frames) {
        Ok(calibrated) => Ok(Some(calibrated)),
        // What these frames leave open stays as it was.
        Err(phalanx_refine::Error::Precision { .. }) => Ok(None),
        Err(error) => Err(Error::from(error)),
    };
    let Some(of_half) = learnt_from(&seen)? else { return Ok(None) };
    let energy = |hand: &HandShape| -> Result<f64> {
        let of_frame = |frame: &BundleFrame| -> Result<f64> {
            let BundleFrame { start, prior, .. } = frame;
            Ok(fitter.refinement.fit(hand, rest, frame.evidence(), start, prior)?.energy)
        };
        let energies: Vec<f64> = held.par_iter().map(of_frame).collect::<Result<_>>()?;
        Ok(energies.iter().sum())
    };
    if energy(&of_half.hand)? >= energy(mean)? {
        return Ok(None);
    }
    let Some(calibrated) = learnt_from(&frames)? else { return Ok(None) };
    let std = KnownHand::anyone(mean).std.into_iter().zip(&calibrated.hand_std);
    let frames = frames.len() as f64;
    let independent = border.independent.min(1.0) / (1.0 + (frames - 1.0) * border.persistent);
    // What the frames tell beside what is known of anyone's hand, as they err together.
    let honest = |(anyone, fitted): (f64, &f64)| {
        let told = fitted.powi(-2) - (beside * anyone).powi(-2);
        (independent * told.max(0.0) + anyone.powi(-2)).powf(-0.5)
    };
    let std = std.map(honest).collect();
    Ok(Some(KnownHand { shape: calibrated.hand, std }))
}

/// The frames whose views agree with their poses. One camera does not tell a hand's size from its distance.
fn telling<'a>(fitter: &FrameFitter<'_>, found: &'a [Option<Found>]) -> Result<Vec<&'a Found>> {
    let found: Vec<&Found> = found.iter().flatten().collect();
    let is_right = |found: &&Found| Ok(found.cameras_used() > 1 && views::is_right(fitter, found)?);
    let right: Vec<bool> = found.par_iter().map(is_right).collect::<Result<_>>()?;
    Ok(found.into_iter().zip(right).filter(|(_, right)| *right).map(|(found, _)| found).collect())
}

/// Every other item, and those between.
fn alternating<T: Clone>(items: &[T]) -> (Vec<T>, Vec<T>) {
    let from = |first: usize| items.iter().skip(first).step_by(2).cloned().collect();
    (from(0), from(1))
}
