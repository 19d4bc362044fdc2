//! Distances that are learnt for groups of targets.

use faer::{Mat, MatRef};

use crate::transform::affine_map::AffineMap;

/// A group of targets and what it reads.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TargetGroup {
    /// Indices of the targets.
    pub outputs: Vec<usize>,
    /// How many of the projected numbers are its own, after those of the groups before.
    pub rank: usize,
}

/// Learnt distances: Euclidean ones between the projected inputs, of which each group of targets
/// looks at its own.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LearnedMetric {
    /// From the inputs to the numbers of all groups, one group's after the other's.
    pub projection: AffineMap,
    /// The groups.
    pub groups: Vec<TargetGroup>,
}

impl LearnedMetric {
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
