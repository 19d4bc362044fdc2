//! How well boundaries are known, from how fits leave them.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec2};
use phalanx_hand::{HandShape, Pose};

use crate::error::Result;
use crate::geometry::correspondence::ViewMatcher;
use crate::geometry::drawn_term::DrawnTerm;
use crate::observation::silhouette::SilhouetteObservation;

/// How far a view's observed boundary is from the boundary of a posed hand, place by place.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryResiduals {
    /// Where along the boundary, px.
    places: Vec<DVec2>,
    /// How far outside the hand, px.
    residuals: Vec<f64>,
    /// Which of the hand's primitives is nearest.
    primitives: Vec<usize>,
}

impl BoundaryResiduals {
    /// Of what one camera saw and a hand in a pose.
    ///
    /// # Errors
    /// A hand that the camera cannot draw.
    pub fn of(
        hand: &HandShape,
        rest: &DAffine3,
        evidence: &SilhouetteObservation,
        pose: &Pose,
    ) -> Result<Self> {
        let mut view = ViewMatcher::new(evidence, FINE)?;
        let posed = hand.pose(pose, rest);
        view.match_boundary(&posed.primitives, evidence, 1, DrawnTerm::Outline)?;
        let scale = evidence.pixels_per_mm(rest.transform_point3(pose.translation()));
        let places = evidence.edges().to_vec();
        let seen = &view.correspondences[..places.len()];
        let residuals = seen.iter().map(|found| scale * found.approach.distance).collect();
        let primitives = seen.iter().map(|found| found.primitive).collect();
        Ok(Self { places, residuals, primitives })
    }
}

/// How well a boundary is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryNoise {
    /// Standard deviation of the boundary's place, px, robustly.
    pub deviation: f64,
    /// How many places of a boundary, on average, tell no more than one does that errs independently.
    pub correlated: f64,
    /// Which share of the variance of the hand's parts, 0 to 1, is the same in every frame: where the hand is
    /// of another shape than its model, more frames tell no more.
    pub persistent: f64,
}

/// How well boundaries are taken to be known when they are drawn, px: better than any is.
const FINE: f64 = 0.5;

/// Distances within which places are asked whether they err together, px: a finger's length.
const FARTHEST: usize = 40;

/// The median of a normal distribution's distances from its middle is this share of the deviation.
const MEDIAN_OF_NORMAL: f64 = 0.6745;

/// Residuals further out than this many deviations are of something else than the boundary's noise.
const OUTLYING: f64 = 3.0;

impl BoundaryNoise {
    /// From the residuals of one view in some frames; `None` of no residual.
    ///
    /// The deviation is the median distance of residuals from their median, scaled as of a normal
    /// distribution. Places at a distance d err together by ρ(d), the mean product of their residuals
    /// over the mean square, up to where that is first not positive; n places then tell as much of
    /// their mean as n² / Σᵢⱼ ρ(dᵢⱼ) that are independent (Bayley and Hammersley 1946).
    pub fn of(views: &[BoundaryResiduals]) -> Option<Self> {
        let mut all: Vec<f64> = views.iter().flat_map(|view| view.residuals.clone()).collect();
        let middle = median(&mut all)?;
        let mut distances: Vec<f64> = all.iter().map(|value| (value - middle).abs()).collect();
        let deviation = (median(&mut distances)? / MEDIAN_OF_NORMAL).max(f64::MIN_POSITIVE);
        let most = OUTLYING * deviation;
        let mut bins = [(0.0, 0_u32); FARTHEST];
        let (mut square, mut count) = (0.0, 0_u32);
        for view in views {
            let clipped: Vec<f64> =
                view.residuals.iter().map(|value| (value - middle).clamp(-most, most)).collect();
            square += clipped.iter().map(|value| value * value).sum::<f64>();
            count += clipped.len() as u32;
            for (i, (value, place)) in clipped.iter().zip(&view.places).enumerate() {
                for (other, at) in clipped[i + 1..].iter().zip(&view.places[i + 1..]) {
                    let bin = place.distance(*at) as usize;
                    if let Some((sum, pairs)) = bins.get_mut(bin) {
                        *sum += value * other;
                        *pairs += 1;
                    }
                }
            }
        }
        let mean_square = (square / f64::from(count)).max(f64::MIN_POSITIVE);
        let together = bins.iter().map(|&(sum, pairs)| (sum / mean_square, pairs));
        let together = together.take_while(|&(sum, pairs)| sum > 0.0 || pairs == 0);
        let sum: f64 = together.map(|(sum, _)| sum).sum();
        let of_frames = views.iter().map(|view| view.parts(middle, most));
        let persistent = intraclass_correlation(&of_frames.collect::<Vec<_>>());
        Some(Self { deviation, correlated: 1.0 + 2.0 * sum / f64::from(count), persistent })
    }
}

impl BoundaryResiduals {
    /// The mean residual of each primitive that the boundary touches, of residuals up to `most` from
    /// `middle`.
    fn parts(&self, middle: f64, most: f64) -> BTreeMap<usize, f64> {
        let mut sums: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
        for (&residual, &primitive) in self.residuals.iter().zip(&self.primitives) {
            let (sum, count) = sums.entry(primitive).or_default();
            *sum += (residual - middle).clamp(-most, most);
            *count += 1.0;
        }
        sums.into_iter().map(|(primitive, (sum, count))| (primitive, sum / count)).collect()
    }
}

/// Which share of the variance of parts' values lies between the parts, from the values of each in some
/// frames: the one-way intraclass correlation (Shrout and Fleiss 1979, ICC(1,1), with the mean number of
/// frames that show a part, Snedecor and Cochran). 0 where no part is seen twice.
fn intraclass_correlation(frames: &[BTreeMap<usize, f64>]) -> f64 {
    let mut parts: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    for (part, value) in frames.iter().flatten() {
        parts.entry(*part).or_default().push(*value);
    }
    let parts: Vec<Vec<f64>> = parts.into_values().filter(|values| values.len() > 1).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let all = parts.concat();
    let (groups, count) = (parts.len() as f64, all.len() as f64);
    if groups < 2.0 {
        return 0.0;
    }
    let (middle, mut between, mut within, mut squares) = (mean(&all), 0.0, 0.0, 0.0);
    for values in &parts {
        let (own, number) = (mean(values), values.len() as f64);
        between += number * (own - middle).powi(2) / (groups - 1.0);
        within += values.iter().map(|value| (value - own).powi(2)).sum::<f64>() / (count - groups);
        squares += number * number;
    }
    let each = (count - squares / count) / (groups - 1.0);
    let total = between + (each - 1.0) * within;
    if total > 0.0 { ((between - within) / total).clamp(0.0, 1.0) } else { 0.0 }
}

fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    let found = values.iter().any(|value| !value.is_nan());
    found.then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forty frames of six parts, each off by its own distance and by as much anew in every frame.
    fn frames(own: f64, anew: f64) -> Vec<BTreeMap<usize, f64>> {
        let wave = |k: usize, by: f64| (by * k as f64).sin() * 2.0_f64.sqrt();
        let value = |frame: usize, part: usize| {
            own * wave(part, 2.4) + anew * wave(7 * frame + 31 * part, 1.7)
        };
        let of_frame = |frame| (0..6).map(|part| (part, value(frame, part))).collect();
        (0..40).map(of_frame).collect()
    }

    #[test]
    fn what_stays_from_frame_to_frame_is_told_from_what_does_not() {
        assert!(intraclass_correlation(&frames(1.0, 0.0)) > 0.999);
        assert!(intraclass_correlation(&frames(0.0, 1.0)) < 0.1);
        let half = intraclass_correlation(&frames(1.0, 1.0));
        assert!((half - 0.5).abs() < 0.15, "{half}");
        assert_eq!(intraclass_correlation(&[]), 0.0);
        assert_eq!(intraclass_correlation(&frames(1.0, 1.0)[..1]), 0.0);
    }
}
