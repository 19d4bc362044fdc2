//! Passes over all frames of a take. A frame depends on the pass before alone, so that all can be fitted
//! at once and come out the same in any order.

use phalanx_camera::Camera;
use rayon::prelude::*;

use super::TakeFrame;
use super::frame_fit::{Found, FrameFitter, Postures};
use super::observation::Sight;
use super::views::{self, Usual};
use crate::{Progress, Result};

/// How many frames before and after a frame say where it may be.
const NEIGHBOURS: usize = 2;

/// All frames, each looked for near where the hand works.
pub(super) fn first(
    cameras: &[Camera],
    frames: &[TakeFrame],
    fitter: &FrameFitter<'_>,
    near: &[glam::DAffine3],
    progress: &dyn Progress,
) -> Result<Vec<Option<Found>>> {
    progress.begin("fit each frame", frames.len());
    let search = |frame: &TakeFrame| {
        let found = fitter.search_near(&Sight::of(cameras, &frame.masks)?, near);
        progress.step();
        found
    };
    frames.par_iter().map(search).collect()
}

/// All frames once more, each from where it was and from where its neighbours are.
pub(super) fn again(
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    postures: Postures,
    progress: &dyn Progress,
) -> Result<Vec<Option<Found>>> {
    progress.begin("fit each frame beside its neighbours", found.len());
    let once = |k: usize| -> Result<Option<Found>> {
        let fitted = match &found[k] {
            Some(own) => {
                let before = found[..k].iter().rev().flatten().take(NEIGHBOURS);
                let after = found[k + 1..].iter().flatten().take(NEIGHBOURS);
                let near: Vec<&Found> = before.chain(after).collect();
                fitter.again(own, &own.left_out, &near, postures)?
            }
            None => None,
        };
        progress.step();
        Ok(fitted)
    };
    (0..found.len()).into_par_iter().map(once).collect()
}

/// What the views of all frames usually leave unexplained, and all frames without the views that
/// disagree.
pub(super) fn agreeing(
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    progress: &dyn Progress,
) -> Result<(Usual, Vec<Option<Found>>)> {
    progress.begin("ask which views agree", found.len());
    let all: Vec<&Found> = found.iter().flatten().collect();
    let shares = |found: &&Found| -> Result<Vec<Option<f64>>> {
        let agreements = views::agreements(fitter, found)?;
        Ok(agreements.iter().map(|agreement| Some((*agreement)?.unexplained)).collect())
    };
    let shares: Vec<Vec<Option<f64>>> = all.par_iter().map(shares).collect::<Result<_>>()?;
    let usual = Usual::of(&shares);
    let agreeing = |found: &Option<Found>| {
        let agreeing = found.as_ref().map(|own| views::without_disagreeing(fitter, own, usual));
        progress.step();
        agreeing.transpose()
    };
    Ok((usual, found.par_iter().map(agreeing).collect::<Result<_>>()?))
}
