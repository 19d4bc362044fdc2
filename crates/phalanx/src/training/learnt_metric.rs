//! Regression in a distance that is learnt for each digit.

use faer::MatRef;
use phalanx_hand::{Digit, Dof};
use phalanx_rvm::{BlockPca, ExpectedGradientOuterProduct, LearnedMetric, NystromRidge};
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::training::feature_transform::blocks;

/// How distances are learnt and regressed with. In a prior without couplings between the digits, what
/// one digit does says nothing of another; a distance of its own for each needs not see every
/// combination.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearntMetric {
    /// Scenes, chosen at random, that principal components and distances are learnt from.
    pub pilot: usize,
    /// Principal components of each view's code, and of what is beside it, at most.
    pub components: usize,
    /// How distances are learnt.
    pub metric: ExpectedGradientOuterProduct,
    /// Gaussians of each digit's regression, at most; some of the pilot's, chosen at random.
    pub centres: usize,
    /// The regression.
    pub regression: NystromRidge,
}

impl LearntMetric {
    /// Learns the distances from a pilot's descriptors, K × n, made of parts of these lengths, and
    /// poses, 28 × n; beside them the parts' principal components, which they are learnt between.
    pub(crate) fn learn(
        &self,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
        parts: &[usize],
    ) -> Result<(LearnedMetric, BlockPca)> {
        Ok(self.metric.fit_with_components(x, y, &blocks(parts, self.components), &groups())?)
    }

    /// The same for so many of a rig's cameras. They leave more open, so that fewer Gaussians tell as much: a
    /// quarter of them through one of three and half through two, which errs as all of them do to within 4 %
    /// and 6 %.
    pub(crate) fn of_fewer_views(&self, views: usize, cameras: usize) -> Self {
        let fewer = |centres: usize| (centres * views).div_ceil(cameras + 1);
        let metric = ExpectedGradientOuterProduct {
            centres: fewer(self.metric.centres),
            gradients: fewer(self.metric.gradients),
            ..self.metric.clone()
        };
        Self { centres: fewer(self.centres), metric, ..self.clone() }
    }
}

/// The numbers of the pose that are regressed together: each digit's, and all others.
fn groups() -> Vec<Vec<usize>> {
    let digits = Digit::ALL.map(|digit| digit.dofs().map(Dof::index).to_vec());
    let others = Dof::ALL.into_iter().filter(|dof| !dof.is_internal()).map(Dof::index).collect();
    digits.into_iter().chain([others]).collect()
}
