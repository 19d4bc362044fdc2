//! The regressors that answer where some of the cameras are missing.

use phalanx_hand::Dof;
use phalanx_rvm::{AffineMap, BlockPca, GroupedRegressor, Mlp, Regressor, Scratch};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::features::descriptor::Descriptor;
use crate::view_set::ViewSet;

/// Regressors for the [learnt](ViewSet::learnt) subsets of an estimator's cameras.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct SubsetRegression {
    /// What all of them read: components of each view's code, and of what is beside it.
    components: BlockPca,
    regressors: SubsetRegressors,
}

/// The regressors, in the order of the subsets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum SubsetRegressors {
    /// One for each subset, which reads the components of its views.
    Own(Vec<GroupedRegressor>),
    /// One for all, which reads the components of zeros where views are missing.
    Shared {
        network: Mlp,
        /// The deviations of each subset.
        deviations: Vec<Vec<f64>>,
    },
}

/// Memory that one prediction after another uses again.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    single: Vec<f32>,
    block: Vec<f64>,
    components: Vec<f64>,
}

impl SubsetRegression {
    pub(crate) fn new(components: BlockPca, regressors: SubsetRegressors) -> Self {
        Self { components, regressors }
    }

    /// Refuses what does not read a descriptor, or does not answer with a pose for every learnt subset.
    pub(crate) fn check(&self, descriptor: &Descriptor) -> Result<()> {
        let views = descriptor.views();
        let subsets = ViewSet::learnt(views);
        let equal = |part, found, expected| {
            if found == expected {
                return Ok(());
            }
            Err(Error::Mismatch { part, found, expected })
        };
        let blocks = descriptor.blocks();
        equal("blocks of components", self.components.blocks().len(), blocks.len())?;
        for (block, length) in self.components.blocks().iter().zip(blocks) {
            equal("inputs of components", block.inputs(), length)?;
        }
        let (own, inputs) = ("regressors of subsets", "inputs of a subset's regressor");
        match &self.regressors {
            SubsetRegressors::Own(regressors) => {
                equal(own, regressors.len(), subsets.len())?;
                for (regressor, subset) in regressors.iter().zip(subsets) {
                    let read = rows(&self.components, views, subset).len();
                    equal(inputs, regressor.inputs(), read)?;
                    equal("outputs of a subset's regressor", regressor.outputs(), Dof::COUNT)?;
                }
            }
            SubsetRegressors::Shared { network, deviations } => {
                equal(own, deviations.len(), subsets.len())?;
                equal(inputs, network.inputs(), self.components.outputs())?;
                equal("outputs of a subset's regressor", network.outputs(), Dof::COUNT)?;
                for deviations in deviations {
                    let usable = |std: &&f64| **std >= 0.0 && std.is_finite();
                    let found = deviations.iter().filter(usable).count();
                    equal("deviations of a subset", found, Dof::COUNT)?;
                    equal("deviations of a subset", deviations.len(), Dof::COUNT)?;
                }
            }
        }
        Ok(())
    }

    /// Mean and standard deviation of the pose for the descriptor of so many views, of which only those of a
    /// subset are read: the learnt one of this number.
    pub(crate) fn predict_into(
        &self,
        (number, subset): (usize, ViewSet),
        (x, views): (&[f64], usize),
        (memory, scratch): (&mut Memory, &mut Scratch),
        mean: &mut [f64],
        std: &mut [f64],
    ) -> phalanx_rvm::Result<()> {
        let Memory { single, block: z, components } = memory;
        components.clear();
        let mut rest = x;
        for (number, block) in self.components.blocks().iter().enumerate() {
            let own;
            (own, rest) = rest.split_at(block.inputs());
            if subset.contains(number % views) {
                block.apply_into(own, single, z)?;
                components.extend_from_slice(z);
            } else if matches!(self.regressors, SubsetRegressors::Shared { .. }) {
                components.extend(of_nothing(block));
            }
        }
        match &self.regressors {
            SubsetRegressors::Own(regressors) => {
                regressors[number].predict_into(components, scratch, mean, std)
            }
            SubsetRegressors::Shared { network, deviations } => {
                network.predict_into(components, scratch, mean, std)?;
                std.copy_from_slice(&deviations[number]);
                Ok(())
            }
        }
    }
}

/// The components of a descriptor's part that is zero.
pub(crate) fn of_nothing(block: &AffineMap) -> impl Iterator<Item = f64> {
    block.parts().offset.iter().map(|&value| f64::from(value))
}

/// The view of each component: blocks go through the views again and again.
pub(crate) fn views_of(components: &BlockPca, views: usize) -> Vec<usize> {
    let blocks = components.blocks().iter().enumerate();
    blocks.flat_map(|(block, map)| std::iter::repeat_n(block % views, map.outputs())).collect()
}

/// The components of some views.
pub(crate) fn rows(components: &BlockPca, views: usize, subset: ViewSet) -> Vec<usize> {
    let of = views_of(components, views);
    (0..of.len()).filter(|&row| subset.contains(of[row])).collect()
}
