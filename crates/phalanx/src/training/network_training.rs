//! How a network is trained on principal components.

use faer::MatRef;
use phalanx_rvm::{BlockPca, IncompleteFit, MissingInputs, MlpTrainer, PcaMlp};
use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::estimator::regression::FittedRegressor;
use crate::estimator::subset_regression::{SubsetRegression, SubsetRegressors};
use crate::progress::Progress;

/// How a network is trained. What it reads of every scene is kept until then: some kilobytes each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NetworkTraining {
    /// Scenes, chosen at random, that principal components are learnt from.
    pub pilot: usize,
    /// Principal components of each view's code, and of what is beside it, at most.
    pub components: usize,
    /// The network.
    pub perceptron: MlpTrainer,
}

impl NetworkTraining {
    /// Passes over the samples by which the network goes on to learn what to do without some of the views.
    fn further_epochs(&self) -> usize {
        self.perceptron.epochs.div_ceil(2)
    }

    /// Fits components of samples, d × I, and their poses, 28 × I; where views may be missing, for what is
    /// left too.
    pub(crate) fn fit(
        &self,
        components: &BlockPca,
        (x, y): (MatRef<'_, f32>, MatRef<'_, f64>),
        missing: Option<&MissingInputs>,
        progress: &dyn Progress,
    ) -> Result<(FittedRegressor, Option<SubsetRegression>)> {
        let Self { perceptron, .. } = self;
        let whole = |network| PcaMlp::from_parts(components.clone(), network);
        let Some(missing) = missing else {
            progress.begin("train the network", perceptron.epochs);
            let trained = perceptron.fit_single(x, y, &mut |_| progress.step())?;
            return Ok((whole(trained.model)?.into(), None));
        };
        let further = self.further_epochs();
        progress.begin("train the network", perceptron.epochs + further);
        let (trained, IncompleteFit { model: network, deviations }) =
            perceptron.fit_incomplete(x, y, missing, further, &mut |_| progress.step())?;
        let regressors = SubsetRegressors::Shared { network, deviations };
        let subsets = SubsetRegression::new(components.clone(), regressors);
        Ok((whole(trained.model)?.into(), Some(subsets)))
    }
}
