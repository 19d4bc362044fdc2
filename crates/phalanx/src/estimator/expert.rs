//! What of an estimator answers where only some of its cameras show the hand.

use phalanx_rvm::Scratch;

use crate::checking::usual::{Explanation, UsualExplanation};
use crate::estimator::error_model::ErrorModel;
use crate::estimator::observation::Observation;
use crate::estimator::regression::FittedRegressor;
use crate::estimator::subset_regression::{Memory, SubsetRegression};
use crate::view_set::ViewSet;

/// What answers for some cameras, all of them perhaps.
#[derive(Clone, Copy)]
pub(crate) struct Expert<'a> {
    regression: Regression<'a>,
    /// The number of views of the estimator.
    views: usize,
    pub(crate) errors: Option<&'a ErrorModel>,
}

#[derive(Clone, Copy)]
enum Regression<'a> {
    All(&'a FittedRegressor),
    /// The learnt subset of this number.
    Subset(&'a SubsetRegression, usize, ViewSet),
}

impl<'a> Expert<'a> {
    /// What answers for all cameras.
    pub(crate) fn of_all(
        regression: &'a FittedRegressor,
        views: usize,
        errors: Option<&'a ErrorModel>,
    ) -> Self {
        Self { regression: Regression::All(regression), views, errors }
    }

    /// What answers for a learnt subset of so many views, by its number.
    pub(crate) fn of_subset(
        regression: &'a SubsetRegression,
        views: usize,
        (number, subset): (usize, ViewSet),
        errors: Option<&'a ErrorModel>,
    ) -> Self {
        Self { regression: Regression::Subset(regression, number, subset), views, errors }
    }

    /// Whether it reads what this camera shows.
    fn reads(&self, camera: usize) -> bool {
        match self.regression {
            Regression::All(_) => true,
            Regression::Subset(.., subset) => subset.contains(camera),
        }
    }

    /// Mean and standard deviation of the pose for a descriptor.
    pub(crate) fn predict_into(
        &self,
        x: &[f64],
        (memory, scratch): (&mut Memory, &mut Scratch),
        mean: &mut [f64],
        std: &mut [f64],
    ) -> phalanx_rvm::Result<()> {
        match self.regression {
            Regression::All(regression) => regression.predict_into(x, scratch, mean, std),
            Regression::Subset(regression, number, subset) => regression.predict_into(
                (number, subset),
                (x, self.views),
                (memory, scratch),
                mean,
                std,
            ),
        }
    }

    /// The views, by their place in the observation, that an answer explains less well than is usual.
    pub(crate) fn short(&self, observation: &Observation, answer: &Explanation) -> Vec<usize> {
        self.short_by(observation, |usual, read| {
            usual.short(&Explanation {
                overlaps: read.iter().map(|&view| answer.overlaps[view]).collect(),
                borders: read.iter().map(|&view| answer.borders[view]).collect(),
            })
        })
    }

    /// The same of borders alone.
    pub(crate) fn short_of_borders(
        &self,
        observation: &Observation,
        borders: &[f64],
    ) -> Vec<usize> {
        self.short_by(observation, |usual, read| {
            let borders: Vec<f64> = read.iter().map(|&view| borders[view]).collect();
            usual.short_of_borders(&borders)
        })
    }

    /// Of views that it does not read it is not known what is usual.
    fn short_by(
        &self,
        observation: &Observation,
        short: impl Fn(&UsualExplanation, &[usize]) -> Vec<usize>,
    ) -> Vec<usize> {
        let Some(errors) = self.errors else { return Vec::new() };
        let views = observation.views.iter().enumerate();
        let read: Vec<usize> =
            views.filter(|(_, view)| self.reads(view.camera)).map(|(place, _)| place).collect();
        short(&errors.usual, &read).into_iter().map(|k| read[k]).collect()
    }
}
