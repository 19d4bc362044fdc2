//! A regressor for each group of targets, on a projection of the inputs that they share.

use faer::{Mat, MatRef};

use crate::data::check;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::predict::Scratch;
use crate::transform::egop::Metric;

/// Models of groups of targets, each of which looks at its own part of what a [`Metric`] makes of
/// the inputs.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "ProjectedParts", into = "ProjectedParts"))]
pub struct Projected {
    metric: Metric,
    models: Vec<Model>,
}

/// What is stored.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct ProjectedParts {
    metric: Metric,
    models: Vec<Model>,
}

impl Projected {
    /// Puts a metric and the models of its groups together; every target belongs to one group.
    pub fn from_parts(metric: Metric, models: Vec<Model>) -> Result<Self> {
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
    pub fn metric(&self) -> &Metric {
        &self.metric
    }

    /// The models, one for each of the metric's groups.
    pub fn models(&self) -> &[Model] {
        &self.models
    }

    /// Length K of an input.
    pub fn inputs(&self) -> usize {
        self.metric.projection.inputs()
    }

    /// Number m of targets.
    pub fn outputs(&self) -> usize {
        self.models.iter().map(Model::outputs).sum()
    }

    /// Mean and standard deviation of the m targets of one input `x` (length K), as
    /// [`Model::predict_into`].
    pub fn predict_into(
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

impl Metric {
    /// The part of the projected numbers `z`, d×n, that the group of this number reads.
    pub fn part<'a>(&self, group: usize, z: MatRef<'a, f64>) -> MatRef<'a, f64> {
        let start = self.groups[..group].iter().map(|group| group.rank).sum();
        z.subrows(start, self.groups[group].rank)
    }

    /// The targets of the group of this number, out of all, m×n.
    pub fn targets(&self, group: usize, y: MatRef<'_, f64>) -> Mat<f64> {
        let outputs = &self.groups[group].outputs;
        Mat::from_fn(outputs.len(), y.ncols(), |place, i| y[(outputs[place], i)])
    }
}

impl TryFrom<ProjectedParts> for Projected {
    type Error = Error;

    fn try_from(parts: ProjectedParts) -> Result<Self> {
        Self::from_parts(parts.metric, parts.models)
    }
}

impl From<Projected> for ProjectedParts {
    fn from(projected: Projected) -> Self {
        Self { metric: projected.metric, models: projected.models }
    }
}
