//! How large a hand is, roughly: from there its proportions are learnt.

use glam::DAffine3;
use phalanx_camera::Camera;
use rayon::prelude::*;

use super::consensus::evenly;
use super::frame_fit::FrameFitter;
use super::observation::Sight;
use super::search;
use super::take_frame::TakeFrame;
use crate::error::Result;
use crate::progress::Progress;

/// Sizes that are tried differ by this factor: within half a step, 7 %, which is how far adults' hands differ,
/// proportions are learnt without trouble.
const STEP: f64 = 1.15;

/// So many steps from the mean adult's hand reach a small child's, and more than the largest adult's.
const STEPS: i32 = 3;

/// Frames that sizes are tried on: each of them tells the size to some per cent.
const FRAMES: usize = 8;

/// The share of its misfit that another size must leave at most: what ragged borders and a hand of another shape leave
/// is left by any size. A choice: of a drawn child's hand the right size left .6; of a real adult's a larger one left .8,
/// and the proportions learnt from there were too long.
const LEFT: f64 = 2.0 / 3.0;

/// Over that of the fitter's hand, the size with which a hand near a place agrees best with what views saw in some
/// frames. Sizes are tried next to each other for as long as that helps. One camera does not tell a hand's size from its
/// distance: before it, and where no other size agrees much better, there is none.
pub(super) fn of_hand(
    fitter: &FrameFitter<'_>,
    cameras: &[Camera],
    frames: &[TakeFrame],
    place: &DAffine3,
    progress: &dyn Progress,
) -> Result<Option<f64>> {
    if cameras.len() < 2 {
        return Ok(None);
    }
    let chosen = evenly(frames.len(), FRAMES);
    let sights = chosen.iter().map(|&k| Sight::of(cameras, &frames[k]));
    let sights: Vec<Sight> = sights.collect::<Result<_>>()?;
    let misfit = |step: i32| -> Result<f64> {
        let hand = fitter.hand.scaled(|| STEP.powi(step));
        let fitter = FrameFitter { hand: &hand, weights: fitter.weights.clone(), ..*fitter };
        progress.begin("try a size of the hand", sights.len());
        let of_frame = |sight: &Sight| {
            let found = search::near(&fitter, sight, &[*place]);
            progress.step();
            Ok(found?.map_or(f64::INFINITY, |found| found.misfit))
        };
        let mut misfits: Vec<f64> = sights.par_iter().map(of_frame).collect::<Result<_>>()?;
        misfits.sort_by(f64::total_cmp);
        Ok(misfits[misfits.len() / 2])
    };
    let given = misfit(0)?;
    let (mut best, mut least) = (0, given);
    for direction in [-1, 1] {
        for step in (1..=STEPS).map(|steps| direction * steps) {
            let other = misfit(step)?;
            if other >= least {
                break;
            }
            (best, least) = (step, other);
        }
    }
    Ok((least < LEFT * given).then(|| STEP.powi(best)))
}
