//! One split of a data set: codebooks, descriptors and every method's errors.

use anyhow::{Context, Result};
use faer::{Mat, MatRef};
use phalanx::PoseContexts;
use phalanx_codebook::KMeans;
use phalanx_hand::{Dof, Pose};
use phalanx_multiview::Vocabulary;
use phalanx_shape_context::BINS;

use super::Job;
use crate::metrics::{AngleErrors, mean_predictor};
use crate::neighbours::nearest_mean;
use crate::split::Split;

/// What is evaluated: some views of a data set under one split. Codebooks, scaling and
/// regressors see the training half only.
pub(crate) struct Trial<'a> {
    pub(crate) contexts: &'a [PoseContexts],
    pub(crate) poses: &'a [Pose],
    pub(crate) views: &'a [usize],
    pub(crate) active: &'a [Dof],
    pub(crate) split: Split,
    pub(crate) seed: u64,
}

/// How one method did.
pub(crate) struct Outcome {
    pub(crate) selected_features: usize,
    /// 0 where the kernel is linear.
    pub(crate) selected_samples: usize,
    pub(crate) train_samples: usize,
    pub(crate) test_samples: usize,
    pub(crate) errors: AngleErrors,
    pub(crate) mean_predictor_mae_deg: f64,
}

/// Descriptors and poses of the two halves.
struct Halves {
    train_x: Mat<f64>,
    train_y: Mat<f64>,
    test_x: Mat<f64>,
    test_y: Mat<f64>,
}

impl Trial<'_> {
    pub(crate) fn run(&self, jobs: &[Job]) -> Result<Vec<(Job, Outcome)>> {
        let halves = self.halves()?;
        let outcome = |job: &Job| {
            let outcome = self.outcome(job, &halves).with_context(|| job.method.name())?;
            Ok((job.clone(), outcome))
        };
        jobs.iter().map(outcome).collect()
    }

    fn halves(&self) -> Result<Halves> {
        let train = self.contexts_of(&self.split.train);
        let vocabulary = Vocabulary {
            clustering: KMeans { seed: self.seed, ..Vocabulary::default().clustering },
            ..Vocabulary::default()
        };
        let views = vocabulary.fit(&train, BINS)?;
        Ok(Halves {
            train_x: phalanx::descriptors(&views, &train)?,
            train_y: self.targets_of(&self.split.train),
            test_x: phalanx::descriptors(&views, &self.contexts_of(&self.split.test))?,
            test_y: self.targets_of(&self.split.test),
        })
    }

    fn contexts_of(&self, samples: &[usize]) -> Vec<PoseContexts> {
        let of = |&i: &usize| self.views.iter().map(|&v| self.contexts[i][v].clone()).collect();
        samples.iter().map(of).collect()
    }

    fn targets_of(&self, samples: &[usize]) -> Mat<f64> {
        phalanx::targets(&samples.iter().map(|&i| self.poses[i]).collect::<Vec<_>>())
    }

    fn outcome(&self, job: &Job, halves: &Halves) -> Result<Outcome> {
        let Halves { train_x, train_y, test_x, test_y } = halves;
        let (features, samples, estimates) = if let Some(fitter) = job.method.regressor(job.counts)
        {
            let model = fitter.fit(train_x, train_y)?.model;
            let (features, samples) = (model.selected_features(), model.kept_samples());
            (features.len(), samples.len(), model.predict(test_x.as_ref())?)
        } else {
            let (x, y) = (train_x.as_ref(), train_y.as_ref());
            let estimates = nearest_mean(x, y, test_x.as_ref(), 5);
            (train_x.nrows(), train_x.ncols(), estimates)
        };
        let errors =
            |estimates: MatRef<'_, f64>| AngleErrors::new(estimates, test_y.as_ref(), self.active);
        Ok(Outcome {
            selected_features: features,
            selected_samples: samples,
            train_samples: train_x.ncols(),
            test_samples: test_x.ncols(),
            errors: errors(estimates.as_ref()),
            mean_predictor_mae_deg: errors(mean_predictor(train_y, test_y.ncols()).as_ref()).mae(),
        })
    }
}
