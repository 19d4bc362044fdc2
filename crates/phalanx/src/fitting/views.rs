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

/// The least share of its border that a view is left unexplained which contradicts the others: one that
/// counts a quarter of what a good view does.
const CONTRADICTION: f64 = 2.0 * DISAGREEMENT;

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
        Self { most: (middle + DEVIATIONS * deviation).exp().max(CONTRADICTION) }
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

/// The least overlap of a view that agrees: drawn redrawings of right poses overlap by .91 (all but
/// 5 %), of wrong ones by .74 at most (95 %), and real borders are worse than drawn ones.
const LEAST_OVERLAP: f64 = 0.7;

impl Usual {
    /// How far a view is from agreeing: up to 1 it does.
    fn contradiction(self, agreement: &Agreement) -> f64 {
        let Agreement { iou, unexplained } = agreement;
        (unexplained / self.most).max((1.0 - iou) / (1.0 - LEAST_OVERLAP))
    }
}

/// A frame without the views that disagree. Where a view contradicts the pose, each view is left out in
/// turn: one is left out for good if all others then agree, or contradict half as much as before, and it
/// does not. Of two views that disagree neither is known to be right.
pub(super) fn without_disagreeing(
    fitter: &FrameFitter<'_>,
    found: &Found,
    usual: Usual,
) -> Result<Found> {
    let mut best = found.clone();
    loop {
        let contradictions = contradictions(fitter, &best, usual)?;
        let used: Vec<usize> = (0..contradictions.len())
            .filter(|&view| contradictions[view].is_some() && !best.left_out[view])
            .collect();
        let worst = used.iter().filter_map(|&view| contradictions[view]).fold(0.0, f64::max);
        if used.len() < 3 || worst <= 1.0 {
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
            Some((rest, without)) if rest <= 1.0 || rest < 0.5 * worst => best = without,
            _ => return Ok(best),
        }
    }
}

/// How far each view of a frame is from agreeing with its fit.
fn contradictions(
    fitter: &FrameFitter<'_>,
    found: &Found,
    usual: Usual,
) -> Result<Vec<Option<f64>>> {
    let agreements = agreements(fitter, found)?;
    Ok(agreements.iter().map(|found| Some(usual.contradiction(found.as_ref()?))).collect())
}

/// The frame fitted without one view more, and how far the others are then from agreeing; `None` if the
/// view agrees all the same.
fn without(
    fitter: &FrameFitter<'_>,
    found: &Found,
    view: usize,
    usual: Usual,
) -> Result<Option<(f64, Found)>> {
    let mut left_out = found.left_out.clone();
    left_out[view] = true;
    let Some(fitted) = fitter.again(found, &left_out, &[], Postures::All)? else { return Ok(None) };
    let contradictions = contradictions(fitter, &fitted, usual)?;
    let of_view = |view: usize| contradictions[view].unwrap_or(0.0);
    let rest = (0..left_out.len()).filter(|&view| !left_out[view]).map(of_view).fold(0.0, f64::max);
    Ok((of_view(view) > 1.0).then_some((rest, fitted)))
}
