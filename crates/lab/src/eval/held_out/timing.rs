//! How long an estimate takes.

use anyhow::{Result, ensure};
use faer::Mat;
use phalanx::{Describer, SceneDescriber, SceneSource};
use phalanx_multiview::Scratch;
use phalanx_segmentation::Silhouette;

use super::ground::Ground;
use super::learner::Learner;
use super::row::Row;
use crate::clock::timed;
use crate::data::sets::Test;

/// Poses that are estimated again and again, at most, and how often.
const POSES: usize = 50;
const ROUNDS: usize = 5;

/// Adds to every row the microseconds from one silhouette for each camera to a pose, on one
/// thread: the fastest of a few rounds over the same poses.
pub(crate) fn add(rows: &mut [Row], learners: &[Learner], ground: &Ground) -> Result<()> {
    let silhouettes = silhouettes(ground)?;
    for learner in learners {
        let views = learner.codebooks.views.len();
        let describing =
            fastest(silhouettes.len(), || describe_all(learner, &silhouettes, ground))?;
        let x = describe_all(learner, &silhouettes, ground)?;
        for (method, predictor) in &learner.predictors {
            // One sample at a time, as in use: no help from other threads or from batches.
            let predict_all = || -> Result<()> {
                for sample in 0..x.ncols() {
                    predictor.predict(x.subcols(sample, 1))?;
                }
                Ok(())
            };
            let time = describing + fastest(x.ncols(), predict_all)?;
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
fn fastest<T>(poses: usize, work: impl Fn() -> Result<T>) -> Result<f64> {
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        least = least.min(timed(&work)?.0);
    }
    Ok(1e6 * least / poses as f64)
}

/// Of unseen motion, camera by camera; poses that some camera does not show are passed over.
fn silhouettes(ground: &Ground) -> Result<Vec<Vec<Silhouette>>> {
    let set = Test::Unseen.set(&ground.rig, &ground.hand, &[]);
    let mut describer = SceneDescriber::new(&ground.rig, ground.rule)?;
    let step = set.count() / POSES;
    let mut seen = Vec::new();
    for number in (0..set.count()).step_by(step) {
        if let Ok(silhouettes) = describer.silhouettes(&set.scene(number)) {
            seen.push(silhouettes.cloned().collect());
        }
    }
    ensure!(!seen.is_empty(), "no pose of unseen motion can be seen by every camera");
    Ok(seen)
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
