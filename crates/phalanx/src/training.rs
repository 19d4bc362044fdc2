//! Learning an estimator for a rig and a hand.

use faer::Mat;
use phalanx_camera::Rig;
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_multiview::{Concatenation, Scratch, Vocabulary};
use phalanx_rvm::{KernelRidge, Lambda, Width};
use rayon::prelude::*;

use crate::{
    Description, Error, Estimator, Framing, OrientationRule, Progress, Regressor, Result,
    describe_poses,
};

/// How an estimator is learnt. The default is the paper's descriptor, turned to the forearm's axis,
/// with dense kernel regression.
///
/// Its kernels are wider and its penalty stronger than leave-one-out would choose: the left-out
/// sample has neighbours in its own sequence, while a photographed hand has none, and narrow
/// kernels answer it with the mean.
#[derive(Debug, Clone)]
pub struct Training {
    /// Which way shape contexts are turned.
    pub orientation: OrientationRule,
    /// What of the pictures is described.
    pub framing: Framing,
    /// The codebooks.
    pub vocabulary: Vocabulary,
    /// The regressor.
    pub regressor: Regressor,
}

impl Default for Training {
    fn default() -> Self {
        Self {
            orientation: OrientationRule::default(),
            framing: Framing::default(),
            vocabulary: Vocabulary::default(),
            regressor: Regressor::KernelRidge(KernelRidge {
                width: Width::Scatter(0.5),
                lambda: Lambda::Given(0.01),
            }),
        }
    }
}

impl Training {
    /// Most scenes whose shape contexts codebooks are learnt from where scenes stream by, evenly
    /// spaced.
    pub const CODEBOOK_SCENES: usize = 1000;

    /// How pictures are described.
    pub(crate) fn description(&self) -> Description {
        Description { orientation: self.orientation, framing: self.framing }
    }

    /// Draws `poses` of the hand through the rig, describes them and learns an estimator. The
    /// same input gives the same estimator at any number of threads.
    ///
    /// # Errors
    /// A rig, hand or pose that cannot be drawn or described, or what the stages report.
    pub fn run(
        &self,
        rig: &Rig,
        hand: &HandShape,
        poses: &[Pose],
        progress: &dyn Progress,
    ) -> Result<Estimator> {
        rig.validate()?;
        hand.validate()?;
        if poses.len() < 2 {
            return Err(Error::TooFewPoses { found: poses.len() });
        }
        let contexts = describe_poses(rig, hand, poses, self.description(), progress)?;
        progress.begin("cluster shape contexts", 1);
        let views = self.vocabulary.fit(&contexts, phalanx_shape_context::BINS)?;
        progress.step();
        let x = descriptors(&views, &contexts)?;
        progress.begin("fit the regressor", 1);
        let fit = self.regressor.fit(&x, &targets(poses))?;
        progress.step();
        Estimator::from_parts(rig.clone(), hand.clone(), self.description(), views, fit.model)
    }
}

/// The joined descriptors of all samples, K × I.
///
/// # Errors
/// What the codebooks say of the contexts.
pub fn descriptors<S, V>(views: &Concatenation, contexts: &[S]) -> Result<Mat<f64>>
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
