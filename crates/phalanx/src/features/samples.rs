//! Samples as the columns of a matrix.

use faer::Mat;
use phalanx_hand::{Dof, Pose};
use phalanx_multiview::{Scratch, ViewEncoders};
use rayon::prelude::*;

use crate::error::Result;

/// The joined descriptors of all samples, K × I.
///
/// # Errors
/// What the codebooks say of the contexts.
pub fn descriptors<S, V>(views: &ViewEncoders, contexts: &[S]) -> Result<Mat<f64>>
where
    S: AsRef<[V]> + Sync,
    V: AsRef<[f32]>,
{
    let mut x = Mat::zeros(views.dim(), contexts.len());
    let columns: Vec<Result<Vec<f64>>> = contexts
        .par_iter()
        .map_init(Scratch::default, |scratch, sample| {
            let mut column = vec![0.0; views.dim()];
            views.describe(sample.as_ref(), scratch, &mut column)?;
            Ok(column)
        })
        .collect();
    for (i, column) in columns.into_iter().enumerate() {
        for (k, value) in column?.into_iter().enumerate() {
            x[(k, i)] = value;
        }
    }
    Ok(x)
}

/// The poses as targets, 28 × I.
pub fn targets(poses: &[Pose]) -> Mat<f64> {
    Mat::from_fn(Dof::COUNT, poses.len(), |dof, i| poses[i].0[dof])
}
