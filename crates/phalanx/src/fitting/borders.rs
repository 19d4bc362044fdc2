//! How well each view's border is known, from how the fits of a take leave it.

use phalanx_refine::{BoundaryNoise, BoundaryResiduals};
use rayon::prelude::*;

use super::frame_fit::{Found, FrameFitter};
use crate::Result;

/// Frames that borders are looked at in.
const FRAMES: usize = 24;

/// How well borders are known, view by view; `None` of a view that no frame uses.
pub(super) fn border_noise(
    fitter: &FrameFitter<'_>,
    found: &[Option<Found>],
) -> Result<Vec<Option<BoundaryNoise>>> {
    let found: Vec<&Found> = found.iter().flatten().collect();
    let chosen = super::consensus::evenly(found.len(), FRAMES);
    let of_view = |view: usize| -> Result<Option<BoundaryNoise>> {
        let mut residuals = Vec::new();
        for &k in &chosen {
            let Found { rest, refined, crops, left_out, .. } = found[k];
            let Some(crop) = crops[view].as_ref().filter(|_| !left_out[view]) else { continue };
            let frame = found[k].frame(fitter.hand);
            let Some(evidence) = fitter.evidence_of(crop, &frame) else { continue };
            residuals.push(BoundaryResiduals::of(fitter.hand, rest, &evidence, &refined.pose)?);
        }
        Ok(BoundaryNoise::of(&residuals))
    };
    (0..fitter.weights.len()).into_par_iter().map(of_view).collect()
}

/// How much a place of each view's border counts beside one that is known independently to `noise`, px.
pub(super) fn weights(borders: &[Option<BoundaryNoise>], noise: f64) -> Vec<f64> {
    let weight = |border: &BoundaryNoise| (noise / border.deviation).powi(2) / border.correlated;
    borders.iter().map(|border| border.as_ref().map_or(1.0, weight)).collect()
}

/// Which share of the borders' variance is the same in every frame, over all views.
pub(super) fn persistent(borders: &[Option<BoundaryNoise>]) -> f64 {
    let seen: Vec<f64> = borders.iter().flatten().map(|border| border.persistent).collect();
    seen.iter().sum::<f64>() / seen.len().max(1) as f64
}

/// The same beside the best view. Poses are fitted with these: the prior of postures is a normal
/// distribution in place of one with two peaks, straight and folded, and pulls every finger between them
/// when it counts as much as borders that err together.
pub(super) fn relative(weights: &[f64]) -> Vec<f64> {
    let most = weights.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    weights.iter().map(|weight| weight / most).collect()
}
