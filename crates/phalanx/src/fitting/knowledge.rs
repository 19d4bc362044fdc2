//! How well borders and landmarks are known, from how the fits of a take leave them.

use glam::DVec2;
use phalanx_hand::JOINTS;
use phalanx_refine::{BoundaryNoise, LandmarkNoise};

use super::borders::border_noise;
use super::found::Found;
use super::frame_fit::FrameFitter;
use super::weights::{PointWeight, ViewWeights};
use crate::error::Result;

/// What a take tells of its views.
pub(super) struct ViewKnowledge {
    pub(super) weights: ViewWeights,
    /// Which share of the variance of what they show is the same in every frame.
    pub(super) persistent: f64,
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
            ..fitter.weights.clone()
        };
        let shares = borders.iter().flatten().map(|own| own.persistent);
        let shares: Vec<f64> =
            shares.chain(points.iter().flatten().map(|own| own.persistent)).collect();
        let persistent = shares.iter().sum::<f64>() / shares.len().max(1) as f64;
        Ok(Self { weights, persistent })
    }
}

/// How well each camera's points are known, mm at the hand, from how the fits of a take leave them; `None`
/// of a camera of which no frame uses any.
fn point_noise(fitter: &FrameFitter<'_>, found: &[Option<Found>]) -> Vec<Option<LandmarkNoise>> {
    let of_camera = |camera: usize| {
        let residuals = |found: &Found| -> Option<[Option<DVec2>; JOINTS]> {
            let points =
                found.points[camera].as_ref().filter(|_| !found.left_out_points(camera))?;
            let frame = found.frame(fitter.hand);
            let scale = points.pixels_per_mm(&frame)?;
            let seen = points.observation(&fitter.weights.points[camera], &frame)?;
            let residuals = seen.residuals(fitter.hand, &found.rest, &found.refined.pose);
            Some(residuals.map(|residual| residual.map(|px| px / scale)))
        };
        let frames: Vec<_> = found.iter().flatten().filter_map(residuals).collect();
        LandmarkNoise::of(&frames)
    };
    (0..fitter.weights.points.len()).map(of_camera).collect()
}
