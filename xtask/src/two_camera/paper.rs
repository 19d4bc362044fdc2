//! The paper's Fig. 10 on these photographs: one view beside two, estimated and refined.

use std::path::Path;

use anyhow::Result;
use image::RgbImage;
use phalanx::{Estimator, Framing, Progress, Refiner, Regressor, Shard, Training, Workspace};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use phalanx_refine::Refinement;
use phalanx_render::Renderer;
use rayon::prelude::*;

use super::{Look, Seen, sheet};
use crate::files;
use crate::held_out::method::nystrom;
use crate::mosaic::mosaic;
use crate::saturation::overlap;
use crate::sets;

/// Frames that are shown, evenly spaced.
const SHOWN: usize = 5;

/// Estimates of all frames through some of the cameras.
struct Estimates {
    what: String,
    estimated: Vec<Pose>,
    refined: Vec<Pose>,
}

/// Draws the figure, and says how well each estimate covers what was seen.
pub(super) fn write(
    folder: &Path,
    rig: &Rig,
    hand: &HandShape,
    samples: usize,
    looks: &[&Look],
    progress: &dyn Progress,
) -> Result<String> {
    let all = nystrom();
    let mut report =
        String::from("overlap with each view, on average over the frames: estimated, refined\n");
    let mut rows = Vec::new();
    for views in 1..=rig.cameras.len() {
        let learning = Learning { rig, hand, samples, views, regressor: all.clone() };
        rows.push(learning.estimates(format!("views: {views}"), looks, progress)?);
    }
    for row in &rows {
        report += &row.line(rig, hand, looks)?;
    }
    draw(&folder.join("fig-10.png"), rig, hand, looks, &rows, |row| &row.estimated)?;
    draw(&folder.join("fig-10-refined.png"), rig, hand, looks, &rows, |row| &row.refined)?;
    Ok(report)
}

/// What is learnt, and through how many of the cameras.
struct Learning<'a> {
    rig: &'a Rig,
    hand: &'a HandShape,
    samples: usize,
    views: usize,
    regressor: Regressor,
}

impl Learning<'_> {
    fn estimates(
        self,
        what: String,
        looks: &[&Look],
        progress: &dyn Progress,
    ) -> Result<Estimates> {
        let Self { rig, hand, samples, views, regressor } = self;
        let cameras = rig.cameras[..views].to_vec();
        let rig = Rig { cameras, ..rig.clone() };
        let training = Training { framing: Framing::Window, regressor, ..Training::default() };
        let set = sets::loosely_placed(&rig, hand, samples);
        let estimator = training.shard(&rig, hand, &set, Shard::WHOLE, progress)?.finish()?;
        let refiner = Refiner::new(&rig, hand, &set.poses, Refinement::default())?;
        let both: Vec<(Pose, Pose)> = looks
            .par_iter()
            .filter_map(|look| look.seen.as_ref().ok())
            .map_init(Workspace::default, |workspace, seen| {
                estimate(&estimator, &refiner, seen, views, workspace)
            })
            .collect::<Result<_>>()?;
        let (estimated, refined) = both.into_iter().unzip();
        Ok(Estimates { what, estimated, refined })
    }
}

/// The pose of one frame, seen by the first cameras, estimated and refined.
fn estimate(
    estimator: &Estimator,
    refiner: &Refiner,
    seen: &Seen,
    views: usize,
    workspace: &mut Workspace,
) -> Result<(Pose, Pose)> {
    let (windows, silhouettes) = (&seen.windows[..views], &seen.silhouettes[..views]);
    let estimate = estimator.estimate_silhouettes(silhouettes, workspace)?;
    let estimate = estimator.place(estimate, windows)?;
    let pairs = windows.iter().zip(silhouettes);
    let evidence: Vec<_> =
        pairs.map(|(window, seen)| window.evidence(seen)).collect::<Result<_, _>>()?;
    let refined = refiner.refine(&evidence, &estimate)?;
    Ok((estimate.pose, refined.pose))
}

impl Estimates {
    /// How much of each view is covered, on average over the frames.
    fn line(&self, rig: &Rig, hand: &HandShape, looks: &[&Look]) -> Result<String> {
        let mean = |poses: &[Pose]| -> Result<String> {
            let mut sums = vec![0.0; rig.cameras.len()];
            for (look, pose) in looks.iter().zip(poses) {
                let Ok(seen) = &look.seen else { continue };
                let solids = hand.pose(pose, &rig.volume.rest_frame()).primitives;
                for ((sum, window), seen) in
                    sums.iter_mut().zip(&seen.windows).zip(&seen.silhouettes)
                {
                    let drawn = Renderer::new(&window.camera)?.silhouette(&solids)?;
                    *sum += overlap(&drawn, &seen.mask);
                }
            }
            let shares = sums.iter().map(|sum| format!("{:.3}", sum / poses.len() as f64));
            Ok(shares.collect::<Vec<_>>().join(" "))
        };
        let (estimated, refined) = (mean(&self.estimated)?, mean(&self.refined)?);
        Ok(format!("  {}: {estimated}; {refined}\n", self.what))
    }
}

/// A row for each number of views: some frames through the windows of all cameras, the hand drawn over.
fn draw(
    path: &Path,
    rig: &Rig,
    hand: &HandShape,
    looks: &[&Look],
    rows: &[Estimates],
    poses: impl Fn(&Estimates) -> &[Pose],
) -> Result<()> {
    let step = looks.len().div_ceil(SHOWN).max(1);
    let rest = rig.volume.rest_frame();
    let mut panels: Vec<RgbImage> = Vec::new();
    let mut columns = 0;
    for row in rows {
        columns = 0;
        for (look, pose) in looks.iter().zip(poses(row)).step_by(step) {
            panels.extend(sheet::fit(look, hand, &rest, pose)?);
            columns += 1;
        }
    }
    files::write_png(path, &mosaic(&panels, columns, 6))
}
