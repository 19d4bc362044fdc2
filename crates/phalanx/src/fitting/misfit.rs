//! How far a pose is from what views show.

use phalanx_refine::{Agreement, PoseFit};

/// A view of which more than this share is unexplained begins to count less than others: hands that are
/// drawn with other proportions and ragged borders leave about half as much.
pub(super) const DISAGREEMENT: f64 = 0.1;

/// The share of its border that a view is left unexplained which contradicts a pose: one that counts a
/// quarter of what a good view does.
const CONTRADICTION: f64 = 2.0 * DISAGREEMENT;

/// The least overlap of a view that agrees: drawn redrawings of right poses overlap by .91 (all but
/// 5 %), of wrong ones by .74 at most (95 %), and real borders are worse than drawn ones.
const LEAST_OVERLAP: f64 = 0.7;

/// The least overlap of a view that no other bears out: a hand that is nearer than it is, of another size, is drawn all
/// around the one that is seen, which leaves little of its border unexplained. Of right poses
/// drawn again all but 5 % overlap by .91 or more; real borders are allowed .03.
const LEAST_OVERLAP_ALONE: f64 = 0.88;

/// How far a view is from agreeing where it begins to count less.
pub(super) const BEGINS: f64 = DISAGREEMENT / CONTRADICTION;

/// How far a view is from agreeing with a pose; beyond 1 it contradicts it in any take.
pub(super) fn of_view(agreement: &Agreement) -> f64 {
    let Agreement { iou, unexplained } = agreement;
    (unexplained / CONTRADICTION).max((1.0 - iou) / (1.0 - LEAST_OVERLAP))
}

/// Whether a view shows something else than a pose that so many cameras tell.
pub(super) fn is_poor(agreement: &Agreement, cameras: usize) -> bool {
    of_view(agreement) > 1.0 || cameras == 1 && agreement.iou < LEAST_OVERLAP_ALONE
}

/// How far `views` views together are from agreeing with a pose, by what each that shows any of the hand
/// says. Of enough views to tell, each counts less the less it agrees.
pub(super) fn of_views(seen: &[f64], views: usize) -> f64 {
    let limit = if views > 2 { BEGINS } else { f64::INFINITY };
    let robust = |misfit: f64| misfit / (1.0 + misfit / limit);
    let of_seen: f64 = seen.iter().map(|&misfit| robust(misfit)).sum();
    // One without a border explains nothing.
    let of_others = (views - seen.len()) as f64 * robust(1.0 / CONTRADICTION);
    (of_seen + of_others) / views.max(1) as f64
}

/// How far a view's landmarks are from agreeing with a pose, by how much of them is unexplained.
pub(super) fn of_points(unexplained: f64) -> f64 {
    unexplained / CONTRADICTION
}

/// How far each view of a fit is from agreeing with it.
fn each(fit: &PoseFit) -> impl Iterator<Item = f64> {
    let views = fit.ious.iter().zip(&fit.unexplained);
    let borders = views.map(|(&iou, &unexplained)| of_view(&Agreement { iou, unexplained }));
    borders.chain(fit.landmarks_unexplained.iter().copied().map(of_points))
}

/// How far `views` views together are from agreeing with a fit to those that show any of the hand.
pub(super) fn of_fit(fit: &PoseFit, views: usize) -> f64 {
    of_views(&each(fit).collect::<Vec<_>>(), views)
}

/// Whether no view contradicts a fit to it in any take.
pub(super) fn agrees(fit: &PoseFit) -> bool {
    each(fit).all(|misfit| misfit <= 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_that_no_other_bears_out_must_overlap_more() {
        let view = |iou: f64| Agreement { iou, unexplained: 0.05 };
        let is_poor = |iou: f64, cameras: usize| is_poor(&view(iou), cameras);
        assert!(is_poor(0.85, 1) && !is_poor(0.9, 1));
        assert!(is_poor(0.65, 2) && !is_poor(0.85, 2));
        assert!(super::is_poor(&Agreement { iou: 0.95, unexplained: 0.3 }, 1));
    }
}
