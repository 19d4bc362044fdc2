//! One row of the held-out table.

use anyhow::{Context, Result};
use faer::MatRef;
use phalanx::{Progress, SceneSource};
use phalanx_hand::Dof;
use rayon::prelude::*;
use serde::Serialize;

use super::errors::{Truth, active_angles};
use super::ground::Ground;
use super::learner::{Learner, describe};
use super::method::{Method, Predictor};
use crate::data::described::Samples;
use crate::data::sets::Set;
use crate::metrics::AngleErrors;

/// How one method, learnt from one set through some cameras, did on one test.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Row {
    pub(crate) train: &'static str,
    pub(crate) train_samples: usize,
    pub(crate) test: &'static str,
    pub(crate) method: &'static str,
    pub(crate) views: usize,
    pub(crate) mae_deg: f64,
    pub(crate) theta_z_mae_deg: f64,
    pub(crate) worst_deg: f64,
    pub(crate) worst_dof: &'static str,
    pub(crate) joint_error_mm: f64,
    pub(crate) kept_samples: usize,
    pub(crate) mean_predictor_mae_deg: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) us_per_estimate: Option<f64>,
}

/// Every learner's every method on one test, whose samples were described with each learner's
/// codebooks.
pub(crate) fn rows(
    test: &'static str,
    learners: &[Learner],
    samples: &[Samples],
    truth: &Truth,
    ground: &Ground,
) -> Result<Vec<Row>> {
    let work: Vec<(&Learner, &Samples, &(Method, Predictor))> = learners
        .iter()
        .zip(samples)
        .flat_map(|(learner, samples)| {
            learner.predictors.iter().map(move |predictor| (learner, samples, predictor))
        })
        .collect();
    let row =
        |&(learner, samples, (method, predictor)): &(&Learner, &Samples, &(Method, Predictor))| {
            let estimates = predictor.predict(samples.x.as_ref())?;
            let guesses = learner.mean.predict(samples.x.as_ref())?;
            let outcome = Outcome {
                train: learner.train,
                train_samples: learner.train_samples,
                method: method.name(),
                views: learner.codebooks.views.len(),
                kept_samples: predictor.kept_samples(),
            };
            outcome.row(test, estimates.as_ref(), guesses.as_ref(), truth, ground)
        };
    work.par_iter().map(row).collect()
}

/// What has been learnt, and from what.
pub(crate) struct Outcome {
    pub(crate) train: &'static str,
    pub(crate) train_samples: usize,
    pub(crate) method: &'static str,
    pub(crate) views: usize,
    pub(crate) kept_samples: usize,
}

impl Outcome {
    /// The row of its estimates on a test, beside guesses; poses, 28 × T.
    pub(crate) fn row(
        self,
        test: &'static str,
        estimates: MatRef<'_, f64>,
        guesses: MatRef<'_, f64>,
        truth: &Truth,
        ground: &Ground,
    ) -> Result<Row> {
        let errors = |of| AngleErrors::new(of, truth.poses.as_ref(), &active_angles());
        let of_method = errors(estimates);
        let (worst_dof, worst_deg) = of_method.worst();
        let (theta_z_mae_deg, _) = of_method.of(Dof::ThetaZ).context("θ_Z is compared")?;
        let Self { train, train_samples, method, views, kept_samples } = self;
        Ok(Row {
            train,
            train_samples,
            test,
            method,
            views,
            mae_deg: of_method.mae(),
            theta_z_mae_deg,
            worst_deg,
            worst_dof: worst_dof.name(),
            joint_error_mm: truth.joint_error_mm(estimates, ground),
            kept_samples,
            mean_predictor_mae_deg: errors(guesses).mae(),
            us_per_estimate: None,
        })
    }
}

/// Every learner's every method on one test set.
pub(crate) fn of_set(
    set: &Set<'_>,
    learners: &[Learner],
    ground: &Ground,
    progress: &dyn Progress,
) -> Result<Vec<Row>> {
    let codebooks: Vec<_> = learners.iter().map(|learner| learner.codebooks.clone()).collect();
    let seen = describe(set, ground.rule, &codebooks, progress)?;
    let truth = Truth::of(seen.numbers.iter().map(|&number| set.scene(number)), ground);
    rows(set.name, learners, &seen.samples, &truth, ground)
}
