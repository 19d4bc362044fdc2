//! Views that disagree with the others.

use phalanx_refine::{Agreement, SilhouetteObservation};
use rayon::prelude::*;

use super::found::Found;
use super::frame_fit::{FrameFitter, Postures};
use super::misfit;
use crate::error::Result;

/// How well each view of a frame, which show these [`silhouettes`](FrameFitter::silhouettes), agrees with its fit.
pub(super) fn agreements(
    fitter: &FrameFitter<'_>,
    found: &Found,
    silhouettes: &[Option<SilhouetteObservation>],
) -> Result<Vec<Option<Agreement>>> {
    let Found { rest, refined, .. } = found;
    let agreement = |seen: &Option<SilhouetteObservation>| {
        let agreement = |seen| fitter.refinement.agreement(fitter.hand, rest, seen, &refined.pose);
        seen.as_ref().map(agreement).transpose()
    };
    Ok(silhouettes.iter().map(agreement).collect::<phalanx_refine::Result<_>>()?)
}

/// How far each view of a frame is from agreeing with its fit, over how far it may be: beyond 1 it contradicts it.
pub(super) struct Contradictions(Vec<Option<f64>>);

impl Contradictions {
    pub(super) fn of(fitter: &FrameFitter<'_>, found: &Found) -> Result<Self> {
        let over = |(far, limit): (Option<f64>, &f64)| far.map(|far| far / limit);
        let misfits = misfits(fitter, found)?.into_iter();
        Ok(Self(misfits.zip(&fitter.weights.limits).map(over).collect()))
    }

    /// The views of the frame that are used and show any of the hand, and how far they are.
    fn used(&self, found: &Found) -> impl Iterator<Item = (usize, f64)> {
        let used = self.0.iter().zip(&found.left_out).enumerate();
        used.filter_map(|(view, (far, left_out))| Some((view, (*far).filter(|_| !left_out)?)))
    }

    /// Whether every view that is used agrees as well as in most of the take's frames.
    pub(super) fn are_usual(&self, found: &Found) -> bool {
        self.used(found).all(|(_, far)| far <= USUAL)
    }

    /// Whether every view that is used agrees, and shows the arm where the fit has it, and the hand at the likelier end
    /// of it.
    pub(super) fn are_none(&self, fitter: &FrameFitter<'_>, found: &Found) -> bool {
        let leaves = |view: usize| !found.left_out[view] && fitter.leaves_picture(found, view);
        self.used(found).all(|(_, far)| far <= 1.0)
            && !(0..found.crops.len()).any(leaves)
            && found.backwards < 0.5
    }
}

/// A frame without the views that disagree. Where a view contradicts the pose, each view is left out in
/// turn: one is left out for good if all others then agree, contradict half as much as before, or are no further off
/// than views of any take may be, and it does not agree. Of two views that disagree neither is known to be right.
pub(super) fn without_disagreeing(
    fitter: &FrameFitter<'_>,
    found: &Found,
) -> Result<(Found, Contradictions)> {
    let mut best = found.clone();
    loop {
        let contradictions = Contradictions::of(fitter, &best)?;
        let used: Vec<usize> = contradictions.used(&best).map(|(view, _)| view).collect();
        let worst = contradictions.used(&best).map(|(_, far)| far).fold(0.0, f64::max);
        if used.len() < 3 || worst <= 1.0 {
            return Ok((best, contradictions));
        }
        let mut likeliest: Option<(f64, Found)> = None;
        for &view in &used {
            let Some((rest, without)) = without(fitter, &best, view)? else { continue };
            if likeliest.as_ref().is_none_or(|likeliest| rest < likeliest.0) {
                likeliest = Some((rest, without));
            }
        }
        let Some((rest, without)) = likeliest else { return Ok((best, contradictions)) };
        let helps = rest <= 1.0
            || rest < 0.5 * worst
            || is_beyond_any(fitter, &best)? && !is_beyond_any(fitter, &without)?;
        if !helps {
            return Ok((best, contradictions));
        }
        best = without;
    }
}

/// Whether a view that is used is further from agreeing than any may be in any take.
pub(super) fn is_beyond_any(fitter: &FrameFitter<'_>, found: &Found) -> Result<bool> {
    let misfits = misfits(fitter, found)?;
    let mut used = misfits.iter().zip(&found.left_out).filter(|(_, left_out)| !**left_out);
    Ok(used.any(|(far, _)| far.is_some_and(|far| far > 1.0)))
}

/// Whether every view of a frame that is used agrees with its fit, and shows the arm where that has it.
pub(super) fn is_right(fitter: &FrameFitter<'_>, found: &Found) -> Result<bool> {
    Ok(Contradictions::of(fitter, found)?.are_none(fitter, found))
}

/// A view that is further from agreeing than this many times what is usual in its take contradicts its frame: of right
/// frames of a real take the worst in twenty were 1.6 times as far as the middle one.
const UNUSUAL: f64 = 2.0;

/// One agrees as well as in most frames that is no further from agreeing than this share of how far it may be: one and a
/// half times what is usual.
const USUAL: f64 = 1.5 / UNUSUAL;

/// How far each view may be from agreeing, by how far it is in most of a take's frames.
pub(super) fn limits(fitter: &FrameFitter<'_>, found: &[Option<Found>]) -> Result<Vec<f64>> {
    let misfits: Vec<Vec<Option<f64>>> =
        found.par_iter().flatten().map(|own| misfits(fitter, own)).collect::<Result<_>>()?;
    let of_view = |view: usize| {
        let mut own: Vec<f64> = misfits.iter().filter_map(|own| *own.get(view)?).collect();
        own.sort_by(f64::total_cmp);
        own.get(own.len() / 2).map_or(1.0, |middle| (UNUSUAL * middle).clamp(misfit::BEGINS, 1.0))
    };
    Ok((0..fitter.weights.limits.len()).map(of_view).collect())
}

/// How far each view of a frame is from agreeing with its fit: its masks', then its landmarks'.
pub(super) fn misfits(fitter: &FrameFitter<'_>, found: &Found) -> Result<Vec<Option<f64>>> {
    let masks = agreements(fitter, found, &fitter.silhouettes(found))?;
    let masks = masks.iter().map(|found| Some(misfit::of_view(found.as_ref()?)));
    let points = points_unexplained(fitter, found)?;
    let points = points.iter().map(|unexplained| unexplained.map(misfit::of_points));
    Ok(masks.chain(points).collect())
}

/// How much of each view's landmarks a fit leaves unexplained, also of those that are left out.
pub(super) fn points_unexplained(
    fitter: &FrameFitter<'_>,
    found: &Found,
) -> Result<Vec<Option<f64>>> {
    let frame = found.frame(fitter.hand);
    let of_view = |camera: usize| {
        let seen = fitter.points_of(&found.points, camera, &frame)?;
        let Found { rest, refined, .. } = found;
        Some(fitter.refinement.landmark_agreement(fitter.hand, rest, &seen, &refined.pose))
    };
    let unexplained = (0..found.points.len()).map(|camera| of_view(camera).transpose());
    Ok(unexplained.collect::<phalanx_refine::Result<_>>()?)
}

/// The frame fitted without one view more, and how far the others are then from agreeing; `None` if the
/// view agrees all the same.
fn without(fitter: &FrameFitter<'_>, found: &Found, view: usize) -> Result<Option<(f64, Found)>> {
    let mut left_out = found.left_out.clone();
    left_out[view] = true;
    let Some(fitted) = fitter.again(found, &left_out, &[], Postures::All)? else { return Ok(None) };
    let contradictions = Contradictions::of(fitter, &fitted)?;
    let rest = contradictions.used(&fitted).map(|(_, far)| far).fold(0.0, f64::max);
    Ok(contradictions.0[view].is_some_and(|far| far > 1.0).then_some((rest, fitted)))
}
