//! Passes over all frames of a take.

use phalanx_camera::Camera;
use phalanx_hand::{HandShape, Pose};
use rayon::prelude::*;

use super::chain::likeliest;
use super::found::Found;
use super::frame_fit::{FrameFitter, Postures};
use super::line_of_sight::LineOfSight;
use super::motion::Motion;
use super::observation::Sight;
use super::repertoire;
use super::search;
use super::take_frame::TakeFrame;
use super::times::Times;
use super::views;
use crate::error::Result;
use crate::progress::Progress;

/// How many frames before and after a frame say where it may be.
const NEIGHBOURS: usize = 1;

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
        let found = search::near(fitter, &Sight::of(cameras, frame)?, near);
        progress.step();
        found
    };
    frames.par_iter().map(search).collect()
}

/// All frames once more, each from where it was, from where its neighbours are and with each digit in other
/// postures; those that agree less than half of all also from the nearest of the better ones, and in the postures that
/// these show. Of what all this leads to, the likeliest poses as they follow each other are kept.
pub(super) fn again(
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    times: &Times,
    progress: &dyn Progress,
) -> Result<Vec<Option<Found>>> {
    progress.begin("fit each frame once more", found.len());
    let is_better = is_better(found);
    let better = found.iter().zip(&is_better).filter(|(_, is_better)| **is_better);
    let shown = repertoire::of(better.filter_map(|(found, _)| found.as_ref()));
    let once = |k: usize| {
        let mut near = neighbours(found, k, |_| true);
        let mut postures: &[Pose] = &[];
        if !is_better[k] {
            // Frames in a row may all be wrong in the same way.
            let better = neighbours(found, k, |other| is_better[other]);
            near.extend(better.into_iter().filter(|(other, _)| other.abs_diff(k) > NEIGHBOURS));
            postures = &shown;
        }
        let near: Vec<&Found> = near.into_iter().map(|(_, found)| found).collect();
        let again =
            |own: &Found| fitter.hypotheses(own, &own.left_out, &near, Postures::Each(postures));
        let fitted = found[k].as_ref().map(again).transpose();
        progress.step();
        Ok(fitted?.unwrap_or_default())
    };
    let hypotheses: Vec<Vec<Found>> =
        (0..found.len()).into_par_iter().map(once).collect::<Result<_>>()?;
    Ok(likeliest(hypotheses, times, fitter))
}

/// All frames from the first to the last and back, each between its neighbours as they are then, from which
/// it is not far: what one frame tells is handed on through all that tell nothing of it.
pub(super) fn swept(
    fitter: &FrameFitter<'_>,
    mut found: Vec<Option<Found>>,
    times: &Times,
    progress: &dyn Progress,
) -> Result<Vec<Option<Found>>> {
    let Some(motion) = Motion::of_found(&found, times, fitter.prior) else { return Ok(found) };
    let along = LineOfSight::of(&found, times, fitter.hand);
    progress.begin("fit each frame between its neighbours", 2 * found.len());
    let count = found.len();
    for k in (0..count).chain((0..count).rev()) {
        progress.step();
        let Some(own) = &found[k] else { continue };
        let near = neighbours(&found, k, |_| true);
        let beside = near.iter().map(|(other, found)| (times.between(k, *other), *found));
        let beside: Vec<_> = beside.collect();
        let mut prior = motion.beside(fitter.prior, &beside)?;
        if let Some(along) = &along {
            prior = along.beside(&prior, &own.frame(fitter.hand), &beside, fitter.hand)?;
        }
        let near: Vec<&Found> = near.into_iter().map(|(_, found)| found).collect();
        let fitter = fitter.with_prior(&prior);
        found[k] = fitter.again(own, &own.left_out, &near, Postures::Given)?;
    }
    Ok(found)
}

/// Which frames' misfit is no more than the median.
fn is_better(found: &[Option<Found>]) -> Vec<bool> {
    let mut misfits: Vec<f64> = found.iter().flatten().map(|found| found.misfit).collect();
    misfits.sort_by(f64::total_cmp);
    let median = misfits.get(misfits.len() / 2).copied().unwrap_or(0.0);
    found.iter().map(|found| found.as_ref().is_some_and(|own| own.misfit <= median)).collect()
}

/// The nearest frames before and after a frame that count and in which a hand was found, with their numbers.
fn neighbours(
    found: &[Option<Found>],
    k: usize,
    is_counted: impl Fn(usize) -> bool,
) -> Vec<(usize, &Found)> {
    let of =
        |other: usize| found[other].as_ref().filter(|_| is_counted(other)).map(|own| (other, own));
    let before = (0..k).rev().filter_map(of).take(NEIGHBOURS);
    before.chain((k + 1..found.len()).filter_map(of).take(NEIGHBOURS)).collect()
}

/// The frames whose views say something else than their poses, or whose arms turn round, each looked for once more where
/// the nearest frames are of which that is not so. What explains more of the views is kept.
pub(super) fn recovered(
    cameras: &[Camera],
    frames: &[TakeFrame],
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    progress: &dyn Progress,
) -> Result<Vec<Option<Found>>> {
    progress.begin("look for the hand where its neighbours are", found.len());
    let is_right = |found: &Option<Found>| match found {
        Some(found) => views::is_right(fitter, found),
        None => Ok(false),
    };
    let right: Vec<bool> = found.par_iter().map(is_right).collect::<Result<_>>()?;
    let once = |k: usize| -> Result<Option<Found>> {
        let near = neighbours(found, k, |other| right[other]);
        let is_turned = |own: &Option<Found>| {
            own.as_ref().is_some_and(|own| is_turned(own, &near, fitter.hand))
        };
        if right[k] && !is_turned(&found[k]) || near.is_empty() {
            return Ok(found[k].clone());
        }
        let places: Vec<_> = near.iter().map(|(_, near)| near.frame(fitter.hand)).collect();
        let search = if is_turned(&found[k]) { search::at } else { search::near };
        let other = search(fitter, &Sight::of(cameras, &frames[k])?, &places)?;
        let near: Vec<&Found> = near.iter().map(|(_, found)| *found).collect();
        let other = match &other {
            Some(other) => {
                // Misfits of other views are not alike.
                let left_out = found[k].as_ref().map_or(&other.left_out, |own| &own.left_out);
                fitter.again(other, left_out, &near, Postures::All)?
            }
            None => None,
        };
        progress.step();
        // What turns round is contradicted by its neighbours as by a view.
        let misfit = |found: &Option<Found>| {
            let turned = f64::from(u8::from(is_turned(found)));
            found.as_ref().map_or(f64::INFINITY, |own| own.misfit + turned)
        };
        Ok(if misfit(&other) < misfit(&found[k]) { other } else { found[k].clone() })
    };
    (0..found.len()).into_par_iter().map(once).collect()
}

/// Whether a frame's arm points the other way than those before and after it, which agree: no arm turns round and back so
/// fast.
fn is_turned(own: &Found, near: &[(usize, &Found)], hand: &HandShape) -> bool {
    let arm = |found: &Found| found.frame(hand).matrix3.z_axis;
    let [(_, before), (_, after)] = near else { return false };
    let [before, own, after] = [before, own, after].map(arm);
    before.dot(after) > 0.0 && before.dot(own) < 0.0 && own.dot(after) < 0.0
}

/// All frames without the views that disagree.
pub(super) fn agreeing(
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
    progress: &dyn Progress,
) -> Result<Vec<Option<Found>>> {
    progress.begin("ask which views agree", found.len());
    let agreeing = |found: &Option<Found>| {
        let agreeing = found.as_ref().map(|own| views::without_disagreeing(fitter, own));
        progress.step();
        Ok(agreeing.transpose()?.map(|(agreeing, _)| agreeing))
    };
    found.par_iter().map(agreeing).collect()
}
