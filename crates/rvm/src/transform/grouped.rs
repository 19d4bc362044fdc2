//! A model for each group of targets, on its own projection of the inputs.

use crate::data::check;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::regressor::Regressor;
use crate::model::scratch::Scratch;
use crate::transform::learned_metric::LearnedMetric;

/// One model for each group of targets. Each reads its own outputs of a [`LearnedMetric`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "GroupedParts", into = "GroupedParts"))]
pub struct GroupedRegressor {
    metric: LearnedMetric,
    models: Vec<Model>,
}

/// What is stored.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct GroupedParts {
    metric: LearnedMetric,
    models: Vec<Model>,
}

impl GroupedRegressor {
    /// Combines a metric with one model for each of its groups. Every target must belong to exactly
    /// one group.
    pub fn from_parts(metric: LearnedMetric, models: Vec<Model>) -> Result<Self> {
        check::length("models of groups", metric.groups.len(), models.len())?;
        let ranks = metric.groups.iter().map(|group| group.rank);
        let read = ranks.fold(0_usize, usize::saturating_add);
        check::length("projected numbers", metric.projection.outputs(), read)?;
        for (group, model) in metric.groups.iter().zip(&models) {
            check::length("inputs of a group's model", group.rank, model.inputs())?;
            check::length("outputs of a group's model", group.outputs.len(), model.outputs())?;
        }
        let mut outputs: Vec<usize> =
            metric.groups.iter().flat_map(|group| group.outputs.iter().copied()).collect();
        outputs.sort_unstable();
        if !outputs.iter().enumerate().all(|(place, &output)| place == output) {
            return Err(Error::Parts { field: "groups", problem: "do not share the targets" });
        }
        Ok(Self { metric, models })
    }

    /// The metric.
    pub fn metric(&self) -> &LearnedMetric {
        &self.metric
    }

    /// The models, one for each of the metric's groups.
    pub fn models(&self) -> &[Model] {
        &self.models
    }
}

impl Regressor for GroupedRegressor {
    fn inputs(&self) -> usize {
        self.metric.projection.inputs()
    }

    fn outputs(&self) -> usize {
        self.models.iter().map(Model::outputs).sum()
    }

    fn predict_into(
        &self,
        x: &[f64],
        scratch: &mut Scratch,
        mean: &mut [f64],
        std: &mut [f64],
    ) -> Result<()> {
        check::answers(self.outputs(), mean, std)?;
        let (mut single, mut z) =
            (std::mem::take(&mut scratch.single), std::mem::take(&mut scratch.projected));
        self.metric.projection.apply_into(x, &mut single, &mut z)?;
        let mut rest = z.as_slice();
        for (group, model) in self.metric.groups.iter().zip(&self.models) {
            let own;
            (own, rest) = rest.split_at(group.rank);
            let outputs = model.outputs();
            let (mut of_group, mut deviations) = (vec![0.0; outputs], vec![0.0; outputs]);
            model.predict_into(own, scratch, &mut of_group, &mut deviations)?;
            for (place, &output) in group.outputs.iter().enumerate() {
                mean[output] = of_group[place];
                std[output] = deviations[place];
            }
        }
        (scratch.single, scratch.projected) = (single, z);
        Ok(())
    }
}

impl TryFrom<GroupedParts> for GroupedRegressor {
    type Error = Error;

    fn try_from(parts: GroupedParts) -> Result<Self> {
        Self::from_parts(parts.metric, parts.models)
    }
}

impl From<GroupedRegressor> for GroupedParts {
    fn from(projected: GroupedRegressor) -> Self {
        Self { metric: projected.metric, models: projected.models }
    }
}
