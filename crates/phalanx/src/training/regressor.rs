//! The regressors that an estimator can be learnt with.

use faer::{Mat, MatRef};
use phalanx_hand::Dof;
use phalanx_rvm::{
    AgarwalTriggs, BasisSpec, BlockPca, Fit, Kernel, KernelRidge, MissingInputs, MultiOutputRvm,
    NystromRidge, OrthogonalLeastSquares, PilotSample, RelevanceVectorMachine, Ridge,
    SufficientStatistics, TwoStageSelection, random_subset,
};
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::estimator::regression::FittedRegressor;
use crate::estimator::subset_regression::SubsetRegression;
use crate::features::descriptor::Descriptor;
use crate::progress::Progress;
use crate::synthesis::scene::SUBSET_SEED;
use crate::training::feature_transform::{FeatureTransform, blocks};
use crate::training::learnt_metric::LearntMetric;
use crate::training::network_training::NetworkTraining;

/// Samples that are added to sums at a time.
const BATCH: usize = 4096;

/// A regressor from descriptors to poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum RegressorConfig {
    /// Ridge regression.
    Ridge(Ridge),
    /// Agarwal and Triggs' column-wise quadratic bridges: the paper's "lin" and "gauss".
    Bridges(AgarwalTriggs),
    /// Features selected linearly, then samples by Gaussian kernels: the paper's "both".
    Cascade(TwoStageSelection),
    /// Orthogonal forward selection over all outputs.
    Forward(OrthogonalLeastSquares),
    /// Tipping's relevance vector machine, one per output.
    Tipping(RelevanceVectorMachine),
    /// The relevance vector machine whose outputs share their vectors.
    MultivariateRvm(MultiOutputRvm),
    /// Dense kernel ridge regression.
    KernelRidge(KernelRidge),
    /// Kernel ridge regression on Gaussians of some of the samples.
    Nystrom(NystromRidge),
    /// Kernel ridge regression on some of the samples' Gaussians, for each digit with a distance of
    /// its own that is learnt first.
    LearntMetric(LearntMetric),
    /// A perceptron on the descriptor's principal components.
    Network(NetworkTraining),
}

/// What training keeps of its scenes for a regressor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kept {
    /// Sums over them, of a size that does not depend on their number.
    Sums,
    /// What the regressor reads of each.
    Readings,
    /// The descriptor of each, which bounds their number.
    Descriptors { regressor: &'static str, most: usize },
}

impl RegressorConfig {
    /// Most samples that Gaussians are put on by default. Of more, as many are candidates, chosen at
    /// random, while all are fitted to: then no matrix has a row or column for each sample.
    pub const CANDIDATES: usize = 2000;

    /// Most samples of a regressor with a basis function on each: a matrix of so many rows and columns
    /// takes 800 MB.
    pub const MOST_DENSE: usize = 10_000;

    /// Most bytes of descriptors that a regressor keeps which needs them all.
    const MOST_BYTES: usize = 1 << 31;

    /// Scenes, at most, that are looked at before the others stream by.
    pub(crate) fn pilot(&self) -> usize {
        match (self.kept(), self) {
            (_, Self::LearntMetric(fitter)) => fitter.pilot,
            (_, Self::Network(fitter)) => fitter.pilot,
            (Kept::Descriptors { .. }, _) => 0,
            _ => Self::CANDIDATES,
        }
    }

    /// Gaussians, at most, that are put on scenes of the pilot.
    pub(crate) fn centres(&self) -> usize {
        match (self.kept(), self) {
            (_, Self::LearntMetric(fitter)) => fitter.centres,
            (Kept::Sums, _) => Self::CANDIDATES,
            (Kept::Readings | Kept::Descriptors { .. }, _) => 0,
        }
    }

    /// What is kept of the scenes.
    pub(crate) fn kept(&self) -> Kept {
        let dense = |regressor| Kept::Descriptors { regressor, most: Self::MOST_DENSE };
        match self {
            Self::Network(_) => Kept::Readings,
            Self::KernelRidge(_) => dense("dense kernel regression"),
            Self::Tipping(fitter) if fitter.kernel != Kernel::Linear => {
                dense("the relevance vector machine with Gaussian kernels")
            }
            Self::Tipping(_) => {
                Kept::Descriptors { regressor: "the relevance vector machine", most: usize::MAX }
            }
            // Features are selected before samples can be summed.
            Self::Cascade(_) => Kept::Descriptors { regressor: "both", most: usize::MAX },
            _ => Kept::Sums,
        }
    }

    /// Refuses more samples than are kept, of descriptors of this length.
    pub(crate) fn check_samples(&self, found: usize, dim: usize) -> Result<()> {
        let Kept::Descriptors { regressor, most } = self.kept() else { return Ok(()) };
        let most = most.min(Self::MOST_BYTES / (dim.max(1) * size_of::<f64>()));
        if found <= most {
            return Ok(());
        }
        Err(Error::TooManySamples { regressor, found, most })
    }

    /// Bytes that are kept of each sample of so many views, where it is not the descriptor.
    pub(crate) fn bytes(&self, views: usize) -> usize {
        let Self::Network(fitter) = self else { return 0 };
        // Of every view's code, and of what is beside it.
        let read = views.saturating_mul(2 * fitter.components);
        read.saturating_mul(size_of::<f32>()) + Dof::COUNT * size_of::<f64>()
    }

    /// Learns what to read of a descriptor from a pilot's descriptors, K × n, and poses, 28 × n.
    pub(crate) fn transform(
        &self,
        x: &Mat<f64>,
        y: &Mat<f64>,
        descriptor: &Descriptor,
        progress: &dyn Progress,
    ) -> Result<FeatureTransform> {
        let parts = descriptor.blocks();
        Ok(match self {
            Self::LearntMetric(fitter) => {
                progress.begin("learn distances", 1);
                let (metric, components) = fitter.learn(x.as_ref(), y.as_ref(), &parts)?;
                progress.step();
                FeatureTransform::Metric { metric, components }
            }
            Self::Network(fitter) => {
                progress.begin("find principal components", 1);
                let components = BlockPca::fit(x.as_ref(), &blocks(&parts, fitter.components))?;
                progress.step();
                FeatureTransform::Components(components)
            }
            _ => FeatureTransform::Whole,
        })
    }

    /// Fits samples themselves: what is read of them, d × I, and their poses, 28 × I; where views may be
    /// missing, for what is left too.
    pub(crate) fn fit_samples(
        &self,
        transform: &FeatureTransform,
        (x, y): (MatRef<'_, f32>, MatRef<'_, f64>),
        missing: Option<&MissingInputs>,
        progress: &dyn Progress,
    ) -> Result<(FittedRegressor, Option<SubsetRegression>)> {
        let (Self::Network(fitter), FeatureTransform::Components(components)) = (self, transform)
        else {
            return Err(Error::Mismatch { part: "principal components", found: 0, expected: 1 });
        };
        fitter.fit(components, (x, y), missing, progress)
    }

    /// Fits targets `y`, m × I, to descriptors `x`, K × I; samples are columns. Of regressors with
    /// Gaussians to choose from, those that work from sums see
    /// [`CANDIDATES`](Self::CANDIDATES) of them.
    ///
    /// # Errors
    /// What the regressor says of its parameters or its data.
    pub fn fit(&self, x: &Mat<f64>, y: &Mat<f64>) -> Result<Fit> {
        let (x, y) = (x.as_ref(), y.as_ref());
        let few = x.ncols() <= Self::CANDIDATES;
        let fit = match self {
            Self::Ridge(fitter) => fitter.fit(x, y),
            Self::Bridges(fitter) if few || fitter.kernel == Kernel::Linear => fitter.fit(x, y),
            Self::Cascade(fitter) if few => fitter.fit(x, y),
            Self::Forward(fitter) if few || fitter.kernel == Kernel::Linear => fitter.fit(x, y),
            Self::Tipping(fitter) => fitter.fit(x, y),
            Self::KernelRidge(fitter) => fitter.fit(x, y),
            Self::MultivariateRvm(fitter) if few || fitter.kernel == Kernel::Linear => {
                fitter.fit(x, y)
            }
            Self::LearntMetric(_) => {
                return Err(Error::InShardsOnly { regressor: "regression in a learnt metric" });
            }
            Self::Network(_) => {
                return Err(Error::InShardsOnly { regressor: "a network on components" });
            }
            Self::Bridges(_)
            | Self::Cascade(_)
            | Self::Forward(_)
            | Self::MultivariateRvm(_)
            | Self::Nystrom(_) => return self.fit_to_sums_of(x, y),
        };
        Ok(fit?)
    }

    /// The basis functions whose sums over the samples are all that a fit needs; `None` of a regressor
    /// that needs the samples themselves.
    pub(crate) fn summed(&self) -> Option<Kernel> {
        match self {
            Self::Ridge(_) => Some(Kernel::Linear),
            Self::Bridges(fitter) => Some(fitter.kernel),
            Self::Forward(fitter) => Some(fitter.kernel),
            Self::MultivariateRvm(fitter) => Some(fitter.kernel),
            Self::Nystrom(fitter) => Some(Kernel::Gaussian(fitter.bandwidth)),
            Self::LearntMetric(fitter) => Some(Kernel::Gaussian(fitter.regression.bandwidth)),
            Self::Cascade(_) | Self::Tipping(_) | Self::KernelRidge(_) | Self::Network(_) => None,
        }
    }

    /// Fits sums over the columns of [`summed`](Self::summed).
    pub(crate) fn fit_sums(&self, columns: &BasisSpec, sums: &SufficientStatistics) -> Result<Fit> {
        Ok(match self {
            Self::Ridge(fitter) => fitter.fit_sums(columns, sums)?,
            Self::Bridges(fitter) => fitter.fit_sums(columns, sums)?,
            Self::Forward(fitter) => fitter.fit_sums(columns, sums)?,
            Self::MultivariateRvm(fitter) => fitter.fit_sums(columns, sums)?,
            Self::Nystrom(fitter) => fitter.fit_sums(columns, sums)?,
            Self::LearntMetric(fitter) => fitter.regression.fit_sums(columns, sums)?,
            Self::Cascade(_) | Self::Tipping(_) | Self::KernelRidge(_) | Self::Network(_) => {
                return Err(Error::Mismatch { part: "sums", found: 1, expected: 0 });
            }
        })
    }

    /// Fits by way of sums over batches of the samples.
    fn fit_to_sums_of(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        let chosen = random_subset(x.ncols(), Self::CANDIDATES, SUBSET_SEED);
        let [pilot_x, pilot_y] = [x, y].map(|all| columns_of(all, &chosen));
        let pilot = PilotSample { x: pilot_x.as_ref(), y: pilot_y.as_ref(), samples: &chosen };
        if let Self::Cascade(fitter) = self {
            let linear = BasisSpec::new(&pilot, Kernel::Linear)?;
            let first = fitter.fit_features(&linear, &sums(&linear, x, y)?)?;
            let kernel = Kernel::Gaussian(fitter.bandwidth);
            let gaussian = BasisSpec::over(&pilot, kernel, first.model.selected_features())?;
            return Ok(fitter.fit_samples(first, &gaussian, &sums(&gaussian, x, y)?)?);
        }
        let expected = Error::Mismatch { part: "sums", found: 0, expected: 1 };
        let columns = BasisSpec::new(&pilot, self.summed().ok_or(expected)?)?;
        self.fit_sums(&columns, &sums(&columns, x, y)?)
    }
}

fn sums(
    columns: &BasisSpec,
    x: MatRef<'_, f64>,
    y: MatRef<'_, f64>,
) -> Result<SufficientStatistics> {
    let mut sums = SufficientStatistics::new(columns);
    for start in (0..x.ncols()).step_by(BATCH) {
        let width = BATCH.min(x.ncols() - start);
        sums.add(columns, x.subcols(start, width), y.subcols(start, width))?;
    }
    Ok(sums)
}

pub(crate) fn columns_of(all: MatRef<'_, f64>, chosen: &[usize]) -> Mat<f64> {
    Mat::from_fn(all.nrows(), chosen.len(), |row, k| all[(row, chosen[k])])
}
