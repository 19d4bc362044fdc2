//! The hand's proportions, from a take.

use glam::DAffine3;
use phalanx_hand::HandShape;
use phalanx_refine::{BundleAdjustment, BundleFrame, ShapePrior};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::consensus::evenly;
use super::frame_fit::{Found, FrameFitter, Seen};
use super::views;
use crate::error::Result;

/// Frames that the hand is learnt from, and as many that it is tested on.
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
}

/// What borders tell of a hand's proportions.
#[derive(Debug, Clone, Copy)]
pub(super) struct HandEvidence {
    /// How many independent places one of the best view's border counts for.
    pub(super) independent: f64,
    /// Which share of a border's variance is the same in every frame.
    pub(super) persistent: f64,
}

/// The hand learnt from half of some frames, beginning with the mean hand, if frames of the other half
/// then fit better than with the hand that they were fitted with; else `None`. Frames whose views contradict
/// their poses tell nothing. A place of the best view's border tells as much as `border.independent` places that err
/// alone, and all frames as much as those would that do not err as others do: so well is the hand known.
pub(super) fn learn(
    mean: &HandShape,
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    rest: &DAffine3,
    border: HandEvidence,
) -> Result<Option<KnownHand>> {
    let found: Vec<&Found> = found.iter().flatten().collect();
    let frame = |found: &Found| {
        let frame = found.frame(fitter.hand);
        let evidence = fitter.seen(&found.crops, &found.points, &found.left_out, &frame);
        let start = found.pose_in(rest, fitter.hand);
        let Seen { silhouettes: observations, landmarks } = evidence;
        BundleFrame { observations, landmarks, start, prior: fitter.prior.clone() }
    };
    // One camera does not tell a hand's size from its distance.
    let is_right = |found: &&Found| Ok(found.cameras_used() > 1 && views::is_right(fitter, found)?);
    let right: Vec<bool> = found.par_iter().map(is_right).collect::<Result<_>>()?;
    let found: Vec<&Found> =
        found.into_iter().zip(right).filter(|(_, right)| *right).map(|(found, _)| found).collect();
    let chosen = evenly(found.len(), 2 * LEARNT_FROM);
    let frames = chosen.iter().map(|&k| frame(found[k]));
    let frames = frames.filter(|frame| !frame.evidence().is_empty());
    let (seen, held) = alternating(frames);
    if held.is_empty() {
        return Ok(None);
    }
    let refinement = fitter.refinement.clone();
    let calibration = BundleAdjustment { pose_fit: refinement, hand: POPULATION, cameras: None };
    let calibrated = match calibration.run(mean, rest, &seen) {
        Ok(calibrated) => calibrated,
        // What these frames leave open stays as it was.
        Err(phalanx_refine::Error::Precision { .. }) => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let energy = |hand: &HandShape| -> Result<f64> {
        let of_frame = |frame: &BundleFrame| -> Result<f64> {
            let BundleFrame { start, prior, .. } = frame;
            Ok(fitter.refinement.fit(hand, rest, frame.evidence(), start, prior)?.energy)
        };
        let energies: Vec<f64> = held.par_iter().map(of_frame).collect::<Result<_>>()?;
        Ok(energies.iter().sum())
    };
    let fits_better = energy(&calibrated.hand)? < energy(fitter.hand)?;
    let std = KnownHand::anyone(mean).std.into_iter().zip(&calibrated.hand_std);
    let frames = seen.len() as f64;
    let independent = border.independent.min(1.0) / (1.0 + (frames - 1.0) * border.persistent);
    // What the frames tell beside what is known of anyone's hand, as they err together.
    let honest = |(anyone, fitted): (f64, &f64)| {
        let told = fitted.powi(-2) - anyone.powi(-2);
        (independent * told.max(0.0) + anyone.powi(-2)).powf(-0.5)
    };
    let std = std.map(honest).collect();
    Ok(fits_better.then_some(KnownHand { shape: calibrated.hand, std }))
}

/// Every other item, and those between.
fn alternating<T>(items: impl Iterator<Item = T>) -> (Vec<T>, Vec<T>) {
    let (mut one, mut other) = (Vec::new(), Vec::new());
    for (k, item) in items.enumerate() {
        if k % 2 == 0 { one.push(item) } else { other.push(item) }
    }
    (one, other)
}
