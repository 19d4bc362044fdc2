//! From descriptors to what a regressor reads.

use faer::Mat;
use phalanx_rvm::{BlockPca, FeatureBlock, LearnedMetric};
use serde::{Deserialize, Serialize};

use crate::error::Result;

/// What the regressor reads of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum FeatureTransform {
    /// Its descriptor.
    Whole,
    /// The descriptor's principal components.
    Components(BlockPca),
    /// What learnt distances make of it. They were learnt between its principal components.
    Metric { metric: LearnedMetric, components: BlockPca },
}

impl FeatureTransform {
    /// What is read of descriptors, a column each.
    pub(crate) fn of(&self, x: Mat<f64>) -> Result<Mat<f64>> {
        Ok(match self {
            Self::Whole => x,
            Self::Components(components) => components.apply(x.as_ref())?,
            Self::Metric { metric, .. } => metric.projection.apply(x.as_ref())?,
        })
    }

    /// How many numbers are read of a descriptor of this length.
    pub(crate) fn count(&self, dim: usize) -> usize {
        match self {
            Self::Whole => dim,
            Self::Components(components) => components.outputs(),
            Self::Metric { metric, .. } => metric.projection.outputs(),
        }
    }
}

/// Parts of a descriptor of these lengths, with at most so many components each.
pub(crate) fn blocks(parts: &[usize], components: usize) -> Vec<FeatureBlock> {
    parts.iter().map(|&inputs| FeatureBlock { inputs, components }).collect()
}
