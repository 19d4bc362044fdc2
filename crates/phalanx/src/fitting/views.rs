//! Views that disagree with the others.

use phalanx_refine::Agreement;

use super::consensus::DISAGREEMENT;
use super::frame_fit::{Found, FrameFitter, Postures};
use crate::Result;

/// How well each view of a frame agrees with its fit, also those that are left out; `None` of a view
/// that sees nothing of it.
pub(super) fn agreements(
    fitter: &FrameFitter<'_>,
    found: &Found,
) -> Result<Vec<Option<Agreement>>> {
    let frame = found.frame(fitter.hand);
    let of_view = |crop: &Option<_>| {
        let evidence = crop.as_ref().and_then(|crop| fitter.evidence_of(crop, &frame));
        let agreement = evidence.map(|evidence| {
            let Found { rest, refined, .. } = found;
            fitter.refinement.agreement(fitter.hand, rest, &evidence, &refined.pose)
        });
        agreement.transpose()
    };
    Ok(found.crops.iter().map(of_view).collect::<phalanx_refine::Result<_>>()?)
}

/// What fits of a take usually leave unexplained.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Usual {
    /// Above this a view, or the mean of a frame's views, is not usual.
    pub(super) most: f64,
}

/// A value this many standard deviations above the median, in logarithms, is not usual: one in seven
/// hundred is.
const DEVIATIONS: f64 = 3.0;

/// The median of a normal distribution's distances from its middle is this share of the deviation.
const MEDIAN_OF_NORMAL: f64 = 0.6745;

impl Usual {
    /// From what each frame's views leave unexplained. The worst view of a frame may be spoilt, if there
    /// are enough to tell; how much views scatter is asked about each view's own middle.
    pub(super) fn of(frames: &[Vec<Option<f64>>]) -> Self {
        let log = |share: f64| share.max(f64::MIN_POSITIVE).ln();
        let mut trusted: Vec<f64> =
            frames.iter().flat_map(|frame| without_worst(frame)).map(log).collect();
        let middle = median(&mut trusted);
        let views = frames.first().map_or(0, Vec::len);
        let mut distances: Vec<f64> = Vec::new();
        for view in 0..views {
            let mut own: Vec<f64> =
                frames.iter().filter_map(|frame| frame[view]).map(log).collect();
            let middle = median(&mut own);
            distances.extend(own.iter().map(|log| (log - middle).abs()));
        }
        let deviation = median(&mut distances) / MEDIAN_OF_NORMAL;
        Self { most: (middle + DEVIATIONS * deviation).exp().max(DISAGREEMENT) }
    }
}

/// The shares of a frame's views but the worst's, if there are more than two.
fn without_worst(shares: &[Option<f64>]) -> Vec<f64> {
    let mut shares: Vec<f64> = shares.iter().flatten().copied().collect();
    shares.sort_by(f64::total_cmp);
    if shares.len() > 2 {
        shares.pop();
    }
    shares
}

fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// A frame without the views that disagree. Where a view is left more unexplained than is usual, each
/// view is left out in turn: one is left out for good if all others are then explained as usual, or
/// better than before by half, and it is not. Of two views that disagree neither is known to be right.
pub(super) fn without_disagreeing(
    fitter: &FrameFitter<'_>,
    found: &Found,
    usual: Usual,
) -> Result<Found> {
    let mut best = found.clone();
    loop {
        let agreements = agreements(fitter, &best)?;
        let used: Vec<usize> = (0..agreements.len())
            .filter(|&view| agreements[view].is_some() && !best.left_out[view])
            .collect();
        let unexplained = |view: usize| agreements[view].map_or(0.0, |found| found.unexplained);
        let worst = used.iter().map(|&view| unexplained(view)).fold(0.0, f64::max);
        if used.len() < 3 || worst <= usual.most {
            return Ok(best);
        }
        let mut likeliest: Option<(f64, Found)> = None;
        for &view in &used {
            let Some((rest, without)) = without(fitter, &best, view, usual)? else { continue };
            if likeliest.as_ref().is_none_or(|likeliest| rest < likeliest.0) {
                likeliest = Some((rest, without));
            }
        }
        match likeliest {
            Some((rest, without)) if rest <= usual.most || rest < 0.5 * worst => best = without,
            _ => return Ok(best),
        }
    }
}

/// The frame fitted without one view more, and the most that another view is left unexplained; `None` if
/// the view is then explained as usual all the same.
fn without(
    fitter: &FrameFitter<'_>,
    found: &Found,
    view: usize,
    usual: Usual,
) -> Result<Option<(f64, Found)>> {
    let mut left_out = found.left_out.clone();
    left_out[view] = true;
    let Some(fitted) = fitter.again(found, &left_out, &[], Postures::All)? else { return Ok(None) };
    let agreements = agreements(fitter, &fitted)?;
    let share = |view: usize| agreements[view].map_or(0.0, |found| found.unexplained);
    let rest = (0..left_out.len()).filter(|&view| !left_out[view]).map(share).fold(0.0, f64::max);
    Ok((share(view) > usual.most).then_some((rest, fitted)))
}
