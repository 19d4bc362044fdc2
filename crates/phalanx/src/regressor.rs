//! The regressors that an estimator can be learnt with.

use faer::{Mat, MatRef};
use phalanx_hand::{Digit, Dof};
use phalanx_rvm::{
    Block, Bridges, Cascade, Columns, Components, Fit, ForwardSelection, GradientMetric, Kernel,
    KernelRidge, Metric, MultivariateRvm, NetworkOnComponents, Nystrom, Perceptron, Pilot, Ridge,
    Sums, Tipping,
};
use serde::{Deserialize, Serialize};

use crate::basis::Reading;
use crate::{Descriptor, Error, Progress, Regression, Result};

/// Samples that are added to sums at a time.
const BATCH: usize = 4096;

/// A regressor from descriptors to poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Regressor {
    /// Ridge regression.
    Ridge(Ridge),
    /// Agarwal and Triggs' column-wise quadratic bridges: the paper's "lin" and "gauss".
    Bridges(Bridges),
    /// Features selected linearly, then samples by Gaussian kernels: the paper's "both".
    Cascade(Cascade),
    /// Orthogonal forward selection over all outputs.
    Forward(ForwardSelection),
    /// Tipping's relevance vector machine, one per output.
    Tipping(Tipping),
    /// The relevance vector machine whose outputs share their vectors.
    MultivariateRvm(MultivariateRvm),
    /// Dense kernel ridge regression.
    KernelRidge(KernelRidge),
    /// Kernel ridge regression on Gaussians of some of the samples.
    Nystrom(Nystrom),
    /// Kernel ridge regression on some of the samples' Gaussians, for each digit with a distance of
    /// its own that is learnt first.
    LearntMetric(LearntMetric),
    /// A perceptron on the descriptor's principal components.
    Network(NetworkTraining),
}

/// How distances are learnt and regressed with. In a prior without couplings between the digits, what
/// one digit does says nothing of another; a distance of its own for each needs not see every
/// combination.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LearntMetric {
    /// Scenes, evenly spaced, that principal components and distances are learnt from.
    pub pilot: usize,
    /// Principal components of each view's code, and of what is beside it, at most.
    pub components: usize,
    /// How distances are learnt.
    pub metric: GradientMetric,
    /// Gaussians of each digit's regression, at most; those of the pilot, evenly spaced.
    pub centres: usize,
    /// The regression.
    pub regression: Nystrom,
}

/// How a network is trained. What it reads of every scene is kept until then: some kilobytes each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NetworkTraining {
    /// Scenes, evenly spaced, that principal components are learnt from.
    pub pilot: usize,
    /// Principal components of each view's code, and of what is beside it, at most.
    pub components: usize,
    /// The network.
    pub perceptron: Perceptron,
}

impl LearntMetric {
    /// Learns the distances from a pilot's descriptors, K × n, made of parts of these lengths, and
    /// poses, 28 × n.
    pub(crate) fn learn(
        &self,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
        parts: &[usize],
    ) -> Result<Metric> {
        Ok(self.metric.learn(x, y, &blocks(parts, self.components), &groups())?)
    }
}

/// Parts of these lengths, with at most so many components each.
fn blocks(parts: &[usize], components: usize) -> Vec<Block> {
    parts.iter().map(|&inputs| Block { inputs, components }).collect()
}

/// The numbers of the pose that are regressed together: each digit's, and all others.
fn groups() -> Vec<Vec<usize>> {
    let digits = Digit::ALL.map(|digit| digit.dofs().map(Dof::index).to_vec());
    let others = Dof::ALL.into_iter().filter(|dof| !dof.is_internal()).map(Dof::index).collect();
    digits.into_iter().chain([others]).collect()
}

impl Regressor {
    /// Most samples that Gaussians are put on by default. Of more, as many are candidates, evenly
    /// spaced, while all are fitted to: then no matrix has a row or column for each sample.
    pub const CANDIDATES: usize = 2000;

    /// Scenes, at most, that are looked at before the others stream by.
    pub(crate) fn pilot(&self) -> usize {
        match self {
            Self::LearntMetric(fitter) => fitter.pilot,
            Self::Network(fitter) => fitter.pilot,
            _ => Self::CANDIDATES,
        }
    }

    /// Gaussians, at most, where scenes stream by.
    pub(crate) fn centres(&self) -> usize {
        match self {
            Self::LearntMetric(fitter) => fitter.centres,
            Self::Network(_) => 0,
            _ => Self::CANDIDATES,
        }
    }

    /// Whether it is fitted to samples rather than to sums over them, where scenes stream by.
    pub(crate) fn needs_samples(&self) -> bool {
        matches!(self, Self::Network(_))
    }

    /// Bytes that are kept of each sample of so many views.
    pub(crate) fn bytes(&self, views: usize) -> usize {
        let Self::Network(fitter) = self else { return 0 };
        // Of every view's code, and of what is beside it.
        let read = views.saturating_mul(2 * fitter.components);
        read.saturating_mul(size_of::<f32>()) + 2 * Dof::COUNT * size_of::<f64>()
    }

    /// Refuses a regressor that cannot be learnt from scenes that stream by.
    pub(crate) fn streams(&self) -> Result<()> {
        if self.needs_samples() { Ok(()) } else { self.summed().map(drop) }
    }

    /// Learns what to read of a descriptor from a pilot's descriptors, K × n, and poses, 28 × n.
    pub(crate) fn reading(
        &self,
        x: &Mat<f64>,
        y: &Mat<f64>,
        descriptor: &Descriptor,
        progress: &dyn Progress,
    ) -> Result<Reading> {
        let parts = descriptor.blocks();
        Ok(match self {
            Self::LearntMetric(fitter) => {
                progress.begin("learn distances", 1);
                let metric = fitter.learn(x.as_ref(), y.as_ref(), &parts)?;
                progress.step();
                Reading::Metric(metric)
            }
            Self::Network(fitter) => {
                progress.begin("find principal components", 1);
                let components = Components::of(x.as_ref(), &blocks(&parts, fitter.components))?;
                progress.step();
                Reading::Components(components)
            }
            _ => Reading::Whole,
        })
    }

    /// Fits samples themselves: what is read of them, d × I, and their poses, 28 × I.
    pub(crate) fn fit_samples(
        &self,
        reading: &Reading,
        x: MatRef<'_, f32>,
        y: MatRef<'_, f64>,
        progress: &dyn Progress,
    ) -> Result<Regression> {
        let (Self::Network(fitter), Reading::Components(components)) = (self, reading) else {
            return Err(Error::Mismatch { part: "principal components", found: 0, expected: 1 });
        };
        progress.begin("train the network", fitter.perceptron.epochs);
        let trained = fitter.perceptron.fit_observed(x, y, &mut |_| progress.step())?;
        Ok(NetworkOnComponents::from_parts(components.clone(), trained.network)?.into())
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

    /// The basis functions whose sums over the samples are all that a fit needs.
    ///
    /// # Errors
    /// A regressor that needs the samples at once, or goes through them twice.
    pub(crate) fn summed(&self) -> Result<Kernel> {
        let not = |regressor, reason| Err(Error::NotInShards { regressor, reason });
        match self {
            Self::Ridge(_) => Ok(Kernel::Linear),
            Self::Bridges(fitter) => Ok(fitter.kernel),
            Self::Forward(fitter) => Ok(fitter.kernel),
            Self::MultivariateRvm(fitter) => Ok(fitter.kernel),
            Self::Nystrom(fitter) => Ok(Kernel::Gaussian(fitter.width)),
            Self::LearntMetric(fitter) => Ok(Kernel::Gaussian(fitter.regression.width)),
            Self::Cascade(_) => {
                not("both", "its features are selected before samples can be summed")
            }
            Self::Tipping(_) => not("Tipping's machine", "it needs all samples at once"),
            Self::Network(_) => not("a network", "it needs its samples, not sums over them"),
            Self::KernelRidge(_) => {
                not("dense kernel regression", "it needs all samples at once; Nyström's does not")
            }
        }
    }

    /// Fits sums over the columns of [`summed`](Self::summed).
    pub(crate) fn fit_sums(&self, columns: &Columns, sums: &Sums) -> Result<Fit> {
        self.summed()?;
        Ok(match self {
            Self::Ridge(fitter) => fitter.fit_sums(columns, sums)?,
            Self::Bridges(fitter) => fitter.fit_sums(columns, sums)?,
            Self::Forward(fitter) => fitter.fit_sums(columns, sums)?,
            Self::MultivariateRvm(fitter) => fitter.fit_sums(columns, sums)?,
            Self::Nystrom(fitter) => fitter.fit_sums(columns, sums)?,
            Self::LearntMetric(fitter) => fitter.regression.fit_sums(columns, sums)?,
            Self::Cascade(_) | Self::Tipping(_) | Self::KernelRidge(_) | Self::Network(_) => {
                unreachable!("refused above")
            }
        })
    }

    /// Fits by way of sums over batches of the samples.
    fn fit_to_sums_of(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        let chosen = evenly_spaced(x.ncols(), Self::CANDIDATES);
        let [pilot_x, pilot_y] = [x, y].map(|all| columns_of(all, &chosen));
        let pilot = Pilot { x: pilot_x.as_ref(), y: pilot_y.as_ref(), samples: &chosen };
        if let Self::Cascade(fitter) = self {
            let linear = Columns::new(&pilot, Kernel::Linear)?;
            let first = fitter.fit_features(&linear, &sums(&linear, x, y)?)?;
            let kernel = Kernel::Gaussian(fitter.width);
            let gaussian = Columns::over(&pilot, kernel, first.model.selected_features())?;
            return Ok(fitter.fit_samples(first, &gaussian, &sums(&gaussian, x, y)?)?);
        }
        let columns = Columns::new(&pilot, self.summed()?)?;
        self.fit_sums(&columns, &sums(&columns, x, y)?)
    }
}

fn sums(columns: &Columns, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Sums> {
    let mut sums = Sums::new(columns);
    for start in (0..x.ncols()).step_by(BATCH) {
        let width = BATCH.min(x.ncols() - start);
        sums.add(columns, x.subcols(start, width), y.subcols(start, width))?;
    }
    Ok(sums)
}

pub(crate) fn columns_of(all: MatRef<'_, f64>, chosen: &[usize]) -> Mat<f64> {
    Mat::from_fn(all.nrows(), chosen.len(), |row, k| all[(row, chosen[k])])
}

/// The numbers of at most `most` of `all` things, evenly spaced.
pub(crate) fn evenly_spaced(all: usize, most: usize) -> Vec<usize> {
    let count = all.min(most);
    (0..count).map(|k| k * all / count).collect()
}
