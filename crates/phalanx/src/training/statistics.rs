//! What a part of a training keeps of its scenes.

use std::collections::BTreeMap;

use faer::Mat;
use phalanx_rvm::{BasisSpec, GroupedRegressor, SufficientStatistics};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::estimator::regression::FittedRegressor;
use crate::estimator::subset_regression::SubsetRegression;
use crate::progress::Progress;
use crate::training::feature_transform::FeatureTransform;
use crate::training::plan::TrainingPlan;
use crate::training::regressor::Kept;
use crate::training::samples::Samples;

/// Enough of the scenes to fit the regressor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum TrainingStatistics {
    /// Sums over the columns of all numbers of the pose, or over those of each group.
    Sums(Vec<SufficientStatistics>),
    /// What the regressor reads of each sample, by the number of its block of scenes.
    Samples(BTreeMap<usize, Samples<f32>>),
    /// The whole descriptor of each sample, likewise.
    Descriptors(BTreeMap<usize, Samples<f64>>),
}

impl TrainingStatistics {
    /// Nothing yet, for a regressor with these columns.
    pub(crate) fn new(plan: &TrainingPlan, columns: &[BasisSpec]) -> Self {
        match plan.regressor.kept() {
            Kept::Sums => Self::Sums(columns.iter().map(SufficientStatistics::new).collect()),
            Kept::Readings => Self::Samples(BTreeMap::new()),
            Kept::Descriptors { .. } => Self::Descriptors(BTreeMap::new()),
        }
    }

    /// Adds the descriptors and poses of a block of scenes.
    pub(crate) fn add(
        &mut self,
        plan: &TrainingPlan,
        columns: &[BasisSpec],
        block: usize,
        x: Mat<f64>,
        y: &Mat<f64>,
    ) -> Result<()> {
        let z = plan.transform.of(x)?;
        match (self, &plan.transform) {
            (Self::Samples(blocks), _) => {
                blocks.insert(block, Samples::new(&z, y, |value| value as f32));
            }
            (Self::Descriptors(blocks), _) => {
                blocks.insert(block, Samples::new(&z, y, |value| value));
            }
            (Self::Sums(sums), FeatureTransform::Metric { metric, .. }) => {
                for (group, (sums, columns)) in sums.iter_mut().zip(columns).enumerate() {
                    let y = metric.targets(group, y.as_ref());
                    sums.add(columns, metric.part(group, z.as_ref()), y.as_ref())?;
                }
            }
            (Self::Sums(sums), _) => sums[0].add(&columns[0], z.as_ref(), y.as_ref())?,
        }
        Ok(())
    }

    /// Adds what another part of the same training keeps.
    pub(crate) fn merge(&mut self, other: Self) -> Result<()> {
        match (self, other) {
            (Self::Sums(sums), Self::Sums(others)) => {
                for (sums, other) in sums.iter_mut().zip(&others) {
                    sums.merge(other)?;
                }
            }
            (Self::Samples(blocks), Self::Samples(others)) => blocks.extend(others),
            (Self::Descriptors(blocks), Self::Descriptors(others)) => blocks.extend(others),
            _ => return Err(Error::ForeignPart { what: "their regressors" }),
        }
        Ok(())
    }

    /// Refuses what does not belong to the regressor, or is not of so many samples in these blocks.
    pub(crate) fn check(
        &self,
        plan: &TrainingPlan,
        columns: &[BasisSpec],
        held: &[usize],
        samples: Option<usize>,
    ) -> Result<()> {
        let foreign = |part, found, expected| Err(Error::Mismatch { part, found, expected });
        let kept = plan.regressor.kept();
        match self {
            Self::Sums(sums) => {
                if sums.len() != columns.len() || kept != Kept::Sums {
                    return foreign("sums", sums.len(), columns.len());
                }
                // Sums refuse to be joined with those of other columns.
                for (columns, sums) in columns.iter().zip(sums) {
                    SufficientStatistics::new(columns).merge(sums)?;
                }
                match sums.iter().find(|sums| Some(sums.samples()) != samples) {
                    Some(sums) => {
                        foreign("samples in the sums", sums.samples(), samples.unwrap_or(0))
                    }
                    None => Ok(()),
                }
            }
            _ if !columns.is_empty() => foreign("sums", 0, columns.len()),
            Self::Samples(blocks) if kept == Kept::Readings => {
                Samples::check(blocks, plan.read(), held, samples)
            }
            Self::Descriptors(blocks) if matches!(kept, Kept::Descriptors { .. }) => {
                Samples::check(blocks, plan.read(), held, samples)
            }
            Self::Samples(_) | Self::Descriptors(_) => foreign("kinds of samples", 0, 1),
        }
    }

    /// The regression that all scenes amount to; of a network those of the cameras' subsets too.
    pub(crate) fn fit(
        self,
        plan: &TrainingPlan,
        progress: &dyn Progress,
    ) -> Result<(FittedRegressor, Option<SubsetRegression>)> {
        let regression = match self {
            Self::Sums(sums) => {
                progress.begin("fit the regressor", 1);
                let regression = fit_sums(&sums, plan)?;
                progress.step();
                regression
            }
            Self::Samples(blocks) => {
                let samples = Samples::of_blocks(blocks);
                let columns = samples.columns(plan.read());
                let missing = plan.missing_views();
                return plan.regressor.fit_samples(
                    &plan.transform,
                    columns,
                    missing.as_ref(),
                    progress,
                );
            }
            Self::Descriptors(blocks) => {
                progress.begin("fit the regressor", 1);
                let samples = Samples::of_blocks(blocks);
                let (x, y) = samples.columns(plan.read());
                let fit = plan.regressor.fit(&x.to_owned(), &y.to_owned())?;
                progress.step();
                fit.model.into()
            }
        };
        Ok((regression, None))
    }
}

fn fit_sums(sums: &[SufficientStatistics], plan: &TrainingPlan) -> Result<FittedRegressor> {
    let work: Vec<(BasisSpec, &SufficientStatistics)> =
        plan.columns()?.into_iter().zip(sums).collect();
    let fit = |(columns, sums): &(BasisSpec, &SufficientStatistics)| {
        Ok(plan.regressor.fit_sums(columns, sums)?.model)
    };
    let mut models = work.par_iter().map(fit).collect::<Result<Vec<_>>>()?;
    Ok(match &plan.transform {
        FeatureTransform::Metric { metric, .. } => {
            GroupedRegressor::from_parts(metric.clone(), models)?.into()
        }
        _ => models.remove(0).into(),
    })
}
