//! How much what each view shows counts.

use phalanx_refine::{BoundaryNoise, LandmarkNoise};
use serde::{Deserialize, Serialize};

use super::borders::border_noise;
use super::frame_fit::{Found, FrameFitter};
use super::points::point_noise;
use crate::Result;

/// How much borders and points count, camera by camera.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ViewWeights {
    /// How much a place of each border counts beside one that is known independently to the fit's noise.
    pub(super) borders: Vec<f64>,
    /// How well each camera's landmarks are known.
    pub(super) points: Vec<PointWeight>,
}

/// How well the landmarks of a camera are known.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct PointWeight {
    /// Standard deviation of a point along each axis, mm at the hand.
    pub(super) std_mm: f64,
    /// How much a point counts beside one that errs independently.
    pub(super) weight: f64,
}

impl PointWeight {
    /// Before anything is known of them: points are as far off as borders may be, a quarter of a finger's
    /// width, and all of a hand count as much as its border, of some 350 places beside 21 points along two
    /// axes.
    const UNKNOWN: Self = Self { std_mm: 4.0, weight: 8.0 };
}

/// What a take tells of its views.
pub(super) struct ViewKnowledge {
    pub(super) weights: ViewWeights,
    /// Which share of the variance of what they show is the same in every frame.
    pub(super) persistent: f64,
}

impl ViewWeights {
    /// Of so many cameras of which nothing is known.
    pub(super) fn unknown(cameras: usize) -> Self {
        Self { borders: vec![1.0; cameras], points: vec![PointWeight::UNKNOWN; cameras] }
    }

    /// How much what counts most counts: a place of the best view's border; of landmarks alone, the best
    /// camera's points.
    pub(super) fn most(&self) -> f64 {
        self.borders.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The same beside the best view. Poses are fitted with these: the prior of postures is a normal
    /// distribution in place of one with two peaks, straight and folded, and pulls every finger between them
    /// when it counts as much as borders that err together.
    pub(super) fn relative(&self) -> Self {
        let most = self.most();
        let point = |point: &PointWeight| PointWeight { weight: point.weight / most, ..*point };
        Self {
            borders: self.borders.iter().map(|weight| weight / most).collect(),
            points: self.points.iter().map(point).collect(),
        }
    }
}

impl ViewKnowledge {
    /// From how the fits of a take leave borders and points.
    pub(super) fn of(fitter: &FrameFitter<'_>, found: &[Option<Found>]) -> Result<Self> {
        let borders = border_noise(fitter, found)?;
        let points = point_noise(fitter, found);
        let noise = fitter.refinement.noise;
        let of_border =
            |border: &BoundaryNoise| (noise / border.deviation).powi(2) / border.correlated;
        let of_points = |points: &LandmarkNoise| PointWeight {
            std_mm: points.deviation,
            weight: points.correlated.recip(),
        };
        let points_weights: Vec<Option<PointWeight>> =
            points.iter().map(|own| own.as_ref().map(of_points)).collect();
        let borders_weights: Vec<Option<f64>> =
            borders.iter().map(|own| own.as_ref().map(of_border)).collect();
        // A camera of which nothing is known counts as the best does.
        let best = |weights: &mut dyn Iterator<Item = f64>| weights.max_by(f64::total_cmp);
        let of_best = best(&mut borders_weights.iter().copied().flatten())
            .or_else(|| best(&mut points_weights.iter().flatten().map(|own| own.weight)));
        let weights = ViewWeights {
            borders: borders_weights.iter().map(|own| own.or(of_best).unwrap_or(1.0)).collect(),
            points: points_weights.iter().map(|own| own.unwrap_or(PointWeight::UNKNOWN)).collect(),
        };
        let shares = borders.iter().flatten().map(|own| own.persistent);
        let shares: Vec<f64> =
            shares.chain(points.iter().flatten().map(|own| own.persistent)).collect();
        let persistent = shares.iter().sum::<f64>() / shares.len().max(1) as f64;
        Ok(Self { weights, persistent })
    }
}
