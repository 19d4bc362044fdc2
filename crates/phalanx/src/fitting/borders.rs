//! How well each view's border is known, from how the fits of a take leave it.

use phalanx_refine::{BoundaryNoise, BoundaryResiduals};
use rayon::prelude::*;

use super::found::Found;
use super::frame_fit::FrameFitter;
use crate::error::Result;

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
    (0..found.first().map_or(0, |own| own.crops.len())).into_par_iter().map(of_view).collect()
}
