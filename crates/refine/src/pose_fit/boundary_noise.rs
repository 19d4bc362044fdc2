//! How well boundaries are known, from how fits leave them.

use glam::{DAffine3, DVec2};
use phalanx_hand::{HandShape, Pose};

use crate::error::Result;
use crate::geometry::correspondence::ViewMatcher;
use crate::observation::silhouette::SilhouetteObservation;

/// How far a view's observed boundary is from the boundary of a posed hand, place by place.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryResiduals {
    /// Where along the boundary, px.
    places: Vec<DVec2>,
    /// How far outside the hand, px.
    residuals: Vec<f64>,
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
        let mut view = ViewMatcher::new(evidence)?;
        let posed = hand.pose(pose, rest);
        view.match_boundary(&posed.primitives, evidence, 1)?;
        let scale = evidence.pixels_per_mm(rest.transform_point3(pose.translation()));
        let seen = view.correspondences.iter().zip(evidence.edges());
        let (residuals, places) =
            seen.map(|(found, &place)| (scale * found.approach.distance, place)).unzip();
        Ok(Self { places, residuals })
    }
}

/// How well a boundary is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundaryNoise {
    /// Standard deviation of the boundary's place, px, robustly.
    pub deviation: f64,
    /// How many places of a boundary, on average, tell no more than one does that errs independently.
    pub correlated: f64,
}

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
        Some(Self { deviation, correlated: 1.0 + 2.0 * sum / f64::from(count) })
    }
}

fn median(values: &mut [f64]) -> Option<f64> {
    let middle = values.len() / 2;
    let found = values.iter().any(|value| !value.is_nan());
    found.then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
