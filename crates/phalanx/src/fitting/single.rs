//! One frame of a hand that is known.

use glam::DAffine3;
use phalanx_camera::Camera;

use super::consensus;
use super::found::Found;
use super::frame_fit::{FrameFitter, Postures};
use super::known::Known;
use super::observation::Sight;
use super::repertoire;
use super::report::{FrameFit, Reporter};
use super::search;
use super::starts;
use super::take::TakeFit;
use super::take_frame::TakeFrame;
use super::views::{self, Contradictions};
use crate::error::{Error, Result};

/// So many places at most, and how far they are from each other at least, turns in radians and ways over half the hand's
/// length: where a hand is looked for, starts are turned by twice as much.
const PLACES: usize = 6;
const SAME_PLACE: f64 = std::f64::consts::FRAC_PI_8;

/// Fits one frame of a hand that a take was fitted to, before the same cameras.
///
/// The hand is looked for where the take's hand works; where a view contradicts it or the others, also where single frames
/// of the take have it, and in their postures; and anywhere if that does not help.
///
/// # Errors
/// Another number of masks or landmarks than cameras, or no camera that sees a hand.
pub fn fit_frame(cameras: &[Camera], frame: &TakeFrame, take: &TakeFit) -> Result<FrameFit> {
    let Known { hand, weights, .. } = &take.known;
    let prior = starts::pose_prior()?;
    let fitter =
        |refinement, weights| FrameFitter { hand: &hand.shape, prior: &prior, refinement, weights };
    let (coarse, fine) = (consensus::searching(cameras.len()), consensus::near());
    let searching = &fitter(&coarse, weights.relative());
    let fitting = &fitter(&fine, weights.relative());
    let sight = &Sight::of(cameras, frame)?;
    let rest = take.volume.volume.rest_frame();
    let (mut found, contradictions) =
        near(searching, fitting, sight, &[rest])?.ok_or(Error::NoHand)?;
    // Those that agree may agree on a wrong pose, and the one that contradicts them may be right.
    let given = weights.left_out(found.points.len());
    if found.left_out != given || !contradictions.are_none(fitting, &found) {
        if let Some((other, _)) = near(searching, fitting, sight, &places(take))? {
            found = better(found, other);
        }
        let shown = repertoire::of_poses(right(take).map(|frame| frame.pose));
        let postures = Postures::Each(&shown);
        if let Some(other) = fitting.again(&found, &given, &[], postures)? {
            found = better(found, views::without_disagreeing(fitting, &other)?.0);
        }
        // Nothing in the take need be like this frame.
        let agree = Contradictions::of(fitting, &found)?.are_none(fitting, &found);
        if (found.left_out != given || !agree)
            && let Some(other) = search::known_anywhere(searching, sight)?
        {
            let other = fitting.improved(other)?;
            found = better(found, views::without_disagreeing(fitting, &other)?.0);
        }
    }
    let fitter = &fitter(&coarse, weights.clone());
    Reporter { cameras, fitter, known: &take.known, rest }.report(&found)
}

/// Frames of a take's hand that differ from each other most, the first being the take's middle.
fn places(take: &TakeFit) -> Vec<DAffine3> {
    let rest = take.volume.volume.rest_frame();
    let frames = right(take).map(|frame| starts::frame_at(&frame.pose, &rest, &take.hand));
    let reach = 0.5 * take.known.hand.shape.length_mm();
    let apart = |one: &DAffine3, other: &DAffine3| consensus::apart(one, other, reach);
    repertoire::spread(std::iter::once(rest).chain(frames), apart, SAME_PLACE, PLACES)
}

/// Its frames that are not doubted.
fn right(take: &TakeFit) -> impl Iterator<Item = &FrameFit> {
    take.frames.iter().filter(|frame| frame.doubts.is_empty())
}

/// A frame looked for near some places, without the views that disagree.
fn near(
    searching: &FrameFitter<'_>,
    fitting: &FrameFitter<'_>,
    sight: &Sight,
    places: &[DAffine3],
) -> Result<Option<(Found, Contradictions)>> {
    let Some(found) = search::near_together(searching, sight, places)? else { return Ok(None) };
    // One that agrees needs no other postures.
    let found = if Contradictions::of(fitting, &found)?.are_usual(&found) {
        fitting.again(&found, &found.left_out, &[], Postures::Given)?.unwrap_or(found)
    } else {
        fitting.improved(found)?
    };
    views::without_disagreeing(fitting, &found).map(Some)
}

/// The one that all views agree with better.
fn better(one: Found, other: Found) -> Found {
    if other.misfit_of_all_views() < one.misfit_of_all_views() { other } else { one }
}
