//! How long an estimate takes.

use std::time::Instant;

use anyhow::Result;
use faer::Mat;
use phalanx::{Describer, draw_silhouette};
use phalanx_multiview::Scratch;
use phalanx_segmentation::Silhouette;

use super::Ground;
use super::learner::Learner;
use super::row::Row;
use crate::sets::Test;

/// Poses that are estimated again and again, and how often.
const POSES: usize = 50;
const ROUNDS: usize = 5;

/// Adds to every row the microseconds from one silhouette for each camera to a pose, on one
/// thread: the fastest of a few rounds over the same poses.
pub(crate) fn add(rows: &mut [Row], learners: &[Learner], ground: &Ground) -> Result<()> {
    let silhouettes = silhouettes(ground)?;
    for learner in learners {
        let views = learner.codebooks.views.len();
        let describing = fastest(|| describe_all(learner, &silhouettes, ground))?;
        let x = describe_all(learner, &silhouettes, ground)?;
        for (method, predictor) in &learner.predictors {
            // One sample at a time, as in use: no help from other threads or from batches.
            let predict_all = || -> Result<()> {
                for sample in 0..x.ncols() {
                    predictor.predict(x.subcols(sample, 1))?;
                }
                Ok(())
            };
            let time = describing + fastest(predict_all)?;
            let of_method = |row: &&mut Row| {
                row.train == learner.train && row.views == views && row.method == method.name()
            };
            for row in rows.iter_mut().filter(of_method) {
                row.us_per_estimate = Some(time);
            }
        }
    }
    Ok(())
}

/// Microseconds for each pose in the fastest round.
fn fastest<T>(work: impl Fn() -> Result<T>) -> Result<f64> {
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        work()?;
        least = least.min(start.elapsed().as_secs_f64());
    }
    Ok(1e6 * least / POSES as f64)
}

/// Of unseen motion, camera by camera.
fn silhouettes(ground: &Ground) -> Result<Vec<Vec<Silhouette>>> {
    let set = Test::Unseen.set(&ground.rig, &ground.hand, &[]);
    let rest = ground.rig.volume.rest_frame();
    let step = set.poses.len() / POSES;
    let poses = set.poses.iter().step_by(step).take(POSES);
    poses
        .map(|pose| {
            let silhouette = |camera| -> Result<Silhouette> {
                let mask = draw_silhouette(camera, &ground.hand, pose, &rest)?;
                Ok(Silhouette::from_mask(&mask)?)
            };
            ground.rig.cameras.iter().map(silhouette).collect()
        })
        .collect()
}

fn describe_all(
    learner: &Learner,
    silhouettes: &[Vec<Silhouette>],
    ground: &Ground,
) -> Result<Mat<f64>> {
    let (mut describer, mut scratch) = (Describer::default(), Scratch::default());
    let mut x = Mat::zeros(learner.codebooks.codebooks.dim(), silhouettes.len());
    for (i, views) in silhouettes.iter().enumerate() {
        let mut contexts = vec![Vec::new(); views.len()];
        for &view in &learner.codebooks.views {
            contexts[view] = describer.contexts(&views[view], ground.rule)?.values().to_vec();
        }
        let column = learner.codebooks.describe(&contexts, &mut scratch)?;
        x.col_as_slice_mut(i).copy_from_slice(&column);
    }
    Ok(x)
}
