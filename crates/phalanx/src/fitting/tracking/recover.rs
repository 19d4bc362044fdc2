//! A hand that was lost.

use glam::DAffine3;
use phalanx_camera::Camera;

use crate::error::Result;
use crate::fitting::found::Found;
use crate::fitting::frame_fit::{FrameFitter, Postures};
use crate::fitting::misfit;
use crate::fitting::observation::Sight;
use crate::fitting::search;
use crate::fitting::take_frame::TakeFrame;

/// Looks for the hand of a frame that was `followed` badly or not at all, step by step further from where
/// it was until all views agree: in other postures, near some frames of hands, anywhere.
pub(super) fn recover(
    fitter: &FrameFitter<'_>,
    cameras: &[Camera],
    frame: &TakeFrame,
    followed: Option<&Found>,
    near: &[DAffine3],
) -> Result<Option<Found>> {
    let mut best: Option<Found> = None;
    if let Some(followed) = followed {
        best = fitter.again(followed, &followed.left_out, &[], Postures::All)?;
    }
    if best.as_ref().is_some_and(|best| misfit::agrees(&best.refined)) {
        return Ok(best);
    }
    let sight = Sight::of(cameras, frame)?;
    let found = if near.is_empty() {
        search::anywhere(fitter, &sight)?
    } else {
        search::near(fitter, &sight, near)?
    };
    if let Some(found) = found {
        best = better(best, Some(fitter.improved(found)?));
    }
    Ok(best)
}

/// The one that views agree with better.
pub(super) fn better(one: Option<Found>, other: Option<Found>) -> Option<Found> {
    match (one, other) {
        (Some(one), Some(other)) if other.misfit < one.misfit => Some(other),
        (Some(one), _) => Some(one),
        (None, other) => other,
    }
}
