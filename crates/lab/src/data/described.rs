//! A data set with what every camera sees of it, and its descriptors.

use anyhow::Result;
use faer::Mat;
use phalanx::PoseContexts;
use phalanx_codebook::KMeans;
use phalanx_hand::{Digit, Dof, Pose};
use phalanx_multiview::{CodebookTrainer, ViewEncoders};
use phalanx_shape_context::BINS;

use crate::data::split::Split;

/// Poses and their shape contexts in every camera of a rig.
pub(crate) struct Described {
    pub(crate) name: String,
    pub(crate) poses: Vec<Pose>,
    /// Of each pose, camera by camera.
    pub(crate) contexts: Vec<PoseContexts>,
    /// The angles that vary: those over which errors are averaged.
    pub(crate) active: Vec<Dof>,
}

/// Descriptors x (K × I) and poses y (28 × I).
pub(crate) struct Samples {
    pub(crate) x: Mat<f64>,
    pub(crate) y: Mat<f64>,
}

impl Samples {
    /// One angle of every pose, degrees.
    pub(crate) fn degrees(&self, dof: Dof) -> Vec<f64> {
        self.y.row(dof.index()).iter().map(|value| value.to_degrees()).collect()
    }

    /// The mean of the fingers' flexions of every pose, degrees; without the thumb's, which bends
    /// by another plan.
    pub(crate) fn flexion(&self) -> Vec<f64> {
        let flexing: Vec<Vec<f64>> = [Digit::Index, Digit::Middle, Digit::Ring, Digit::Little]
            .into_iter()
            .flat_map(|digit| digit.dofs().into_iter().skip(1))
            .map(|dof| self.degrees(dof))
            .collect();
        let mean = |i| flexing.iter().map(|angles| angles[i]).sum::<f64>() / flexing.len() as f64;
        (0..self.y.ncols()).map(mean).collect()
    }
}

/// The two halves of a split. Codebooks see the training half only.
pub(crate) struct Halves {
    pub(crate) codebooks: ViewEncoders,
    pub(crate) train: Samples,
    pub(crate) test: Samples,
}

impl Described {
    /// The even split of this seed as some of the cameras, given by their numbers, see it.
    pub(crate) fn halves(&self, views: &[usize], seed: u64) -> Result<Halves> {
        let split = Split::even(self.poses.len(), seed);
        let codebooks = self.codebooks(views, &split.train, seed)?;
        Ok(Halves {
            train: self.samples(&codebooks, views, &split.train)?,
            test: self.samples(&codebooks, views, &split.test)?,
            codebooks,
        })
    }

    /// All samples as some of the cameras see them, with codebooks learnt from all of them.
    pub(crate) fn whole(&self, views: &[usize], seed: u64) -> Result<(ViewEncoders, Samples)> {
        let all: Vec<usize> = (0..self.poses.len()).collect();
        let codebooks = self.codebooks(views, &all, seed)?;
        let samples = self.samples(&codebooks, views, &all)?;
        Ok((codebooks, samples))
    }

    /// The paper's codebooks, learnt from some samples.
    fn codebooks(&self, views: &[usize], samples: &[usize], seed: u64) -> Result<ViewEncoders> {
        Ok(vocabulary(seed).fit(&self.seen(views, samples), BINS)?)
    }

    /// Descriptors and poses of some samples.
    fn samples(
        &self,
        codebooks: &ViewEncoders,
        views: &[usize],
        samples: &[usize],
    ) -> Result<Samples> {
        let poses: Vec<Pose> = samples.iter().map(|&i| self.poses[i]).collect();
        let x = phalanx::descriptors(codebooks, &self.seen(views, samples))?;
        Ok(Samples { x, y: phalanx::targets(&poses) })
    }

    /// The shape contexts of some samples in some of the cameras.
    pub(crate) fn seen(&self, views: &[usize], samples: &[usize]) -> Vec<Vec<&[f32]>> {
        let of = |&i: &usize| views.iter().map(|&v| self.contexts[i][v].as_slice()).collect();
        samples.iter().map(of).collect()
    }
}

/// The paper's vocabulary, clustered from this seed.
pub(crate) fn vocabulary(seed: u64) -> CodebookTrainer {
    let default = CodebookTrainer::default();
    CodebookTrainer { clustering: KMeans { seed, ..default.clustering }, ..default }
}
