//! One split of a data set: codebooks, descriptors and every method's errors.

use anyhow::{Context, Result};
use faer::MatRef;
use phalanx_hand::Dof;

use super::job::Job;
use crate::baselines::neighbours::nearest_mean;
use crate::data::described::{Halves, Samples};
use crate::metrics::{AngleErrors, mean_predictor};

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

/// Every job's outcome on one split; errors are averaged over `active`.
pub(crate) fn run(halves: &Halves, active: &[Dof], jobs: &[Job]) -> Result<Vec<(Job, Outcome)>> {
    let outcome = |job: &Job| {
        let outcome = outcome(halves, active, job).with_context(|| job.method.name())?;
        Ok((job.clone(), outcome))
    };
    jobs.iter().map(outcome).collect()
}

fn outcome(halves: &Halves, active: &[Dof], job: &Job) -> Result<Outcome> {
    let Halves { train, test, .. } = halves;
    let (features, samples, estimates) = if let Some(fitter) = job.method.regressor(job.counts) {
        let model = fitter.fit(&train.x, &train.y)?.model;
        let (features, samples) = (model.selected_features(), model.kept_samples());
        (features.len(), samples.len(), model.predict(test.x.as_ref())?)
    } else {
        let Samples { x, y } = train;
        let estimates = nearest_mean(x.as_ref(), y.as_ref(), test.x.as_ref(), 5);
        (x.nrows(), x.ncols(), estimates)
    };
    let errors = |estimates: MatRef<'_, f64>| AngleErrors::new(estimates, test.y.as_ref(), active);
    let guesses = mean_predictor(&train.y, test.y.ncols());
    Ok(Outcome {
        selected_features: features,
        selected_samples: samples,
        train_samples: train.x.ncols(),
        test_samples: test.x.ncols(),
        errors: errors(estimates.as_ref()),
        mean_predictor_mae_deg: errors(guesses.as_ref()).mae(),
    })
}
