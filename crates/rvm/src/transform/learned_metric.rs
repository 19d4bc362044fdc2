//! Learned distances for groups of targets.

use faer::{Mat, MatRef};

use crate::transform::affine_map::AffineMap;

/// A group of targets, and the number of directions that it reads.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TargetGroup {
    /// Indices of the targets.
    pub outputs: Vec<usize>,
    /// Number of projected directions; they follow those of the previous groups.
    pub rank: usize,
}

/// Learned distances: Euclidean distances between projected inputs, with separate directions for
/// each group of targets.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LearnedMetric {
    /// From the inputs to the directions of all groups, concatenated.
    pub projection: AffineMap,
    /// The groups.
    pub groups: Vec<TargetGroup>,
}

impl LearnedMetric {
    /// The rows of the projected inputs `z`, d×n, that a group reads.
    pub fn part<'a>(&self, group: usize, z: MatRef<'a, f64>) -> MatRef<'a, f64> {
        let start = self.groups[..group].iter().map(|group| group.rank).sum();
        z.subrows(start, self.groups[group].rank)
    }

    /// The rows of the targets `y`, m×n, that belong to a group.
    pub fn targets(&self, group: usize, y: MatRef<'_, f64>) -> Mat<f64> {
        let outputs = &self.groups[group].outputs;
        Mat::from_fn(outputs.len(), y.ncols(), |place, i| y[(outputs[place], i)])
    }
}
