//! The methods that the held-out table compares.

use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use faer::{Mat, MatRef};
use phalanx::{Framing, Preset, RegressorConfig};
use phalanx_rvm::{Bandwidth, KernelRidge, Model, NystromRidge};

use crate::baselines::neighbours::nearest_mean;
use crate::data::described::Samples;
use crate::eval::table1::{PaperCounts, TableMethod};
use crate::metrics::mean_predictor;

/// A column's method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum Method {
    /// The mean of the training poses.
    Mean,
    /// Linear bridges, features at the paper's count.
    Lin,
    /// Gaussian bridges, samples at the paper's count.
    Gauss,
    /// Both, at the paper's counts.
    Both,
    /// Orthogonal forward selection of as many samples as `gauss`.
    Forward,
    /// Gaussian kernel regression on all samples or, of many, on 2,000 of them.
    Kernel,
    /// The mean of the five nearest neighbours.
    Knn5,
    /// The fast preset, whatever the training set.
    Fast,
    /// The default preset, whatever the training set.
    Preset,
    /// The best preset, whatever the training set.
    Best,
    /// The default preset's estimates refined, with the mean hand.
    Refined,
    /// The same, with the hand calibrated from 20 other frames.
    RefinedOwnHand,
}

/// How a learnt preset answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Answer {
    /// By its estimate.
    Estimate,
    /// By that refined, with the hand as given.
    Refined,
    /// By that refined, with the hand calibrated from other frames.
    RefinedOwnHand,
}

impl Answer {
    /// Hands are calibrated from whole pictures only.
    pub(crate) fn is_given(self, framing: Framing) -> bool {
        framing == Framing::Picture || self != Self::RefinedOwnHand
    }
}

/// Something that estimates poses from descriptors.
pub(crate) enum Predictor {
    Model(Box<Model>),
    Nearest(Samples),
    Mean(Mat<f64>),
}

impl Method {
    /// Those that learn from the paper's descriptors.
    pub(crate) const OF_DESCRIPTORS: [Self; 7] =
        [Self::Mean, Self::Lin, Self::Gauss, Self::Both, Self::Forward, Self::Kernel, Self::Knn5];

    /// The preset, of those that are one: they learn from scenes of their own.
    pub(crate) fn preset(self) -> Option<(Preset, Answer)> {
        match self {
            Self::Fast => Some((Preset::Fast, Answer::Estimate)),
            Self::Preset => Some((Preset::Default, Answer::Estimate)),
            Self::Best => Some((Preset::Best, Answer::Estimate)),
            Self::Refined => Some((Preset::Default, Answer::Refined)),
            Self::RefinedOwnHand => Some((Preset::Default, Answer::RefinedOwnHand)),
            _ => None,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Lin => "lin",
            Self::Gauss => "gauss",
            Self::Both => "both",
            Self::Forward => "forward",
            Self::Kernel => "kernel",
            Self::Knn5 => "knn5",
            Self::Fast => "fast",
            Self::Preset => "preset",
            Self::Best => "best",
            Self::Refined => "refined",
            Self::RefinedOwnHand => "refined_own_hand",
        }
    }

    pub(crate) fn fit(self, samples: &Samples, counts: PaperCounts) -> Result<Predictor> {
        let fitted = |regressor: &RegressorConfig| -> Result<Predictor> {
            Ok(Predictor::Model(Box::new(regressor.fit(&samples.x, &samples.y)?.model)))
        };
        let of_table =
            |method: TableMethod| fitted(&method.regressor(counts).context("it is fitted")?);
        match self {
            Self::Mean => Ok(Predictor::Mean(mean_predictor(&samples.y, 1))),
            Self::Lin => of_table(TableMethod::Lin),
            Self::Gauss => of_table(TableMethod::Gauss),
            Self::Both => of_table(TableMethod::Both),
            Self::Forward => of_table(TableMethod::Forward),
            Self::Kernel => fitted(&kernel_regression(samples.x.ncols())),
            Self::Knn5 => {
                let (x, y) = (samples.x.clone(), samples.y.clone());
                Ok(Predictor::Nearest(Samples { x, y }))
            }
            Self::Fast | Self::Preset | Self::Best | Self::Refined | Self::RefinedOwnHand => {
                bail!("a preset does not learn from the paper's descriptors")
            }
        }
    }
}

/// Width of the kernels of `kernel`: wider than leave-one-out would have them, to which the
/// neighbours in a sample's own sequence are near.
const WIDTH: Bandwidth = Bandwidth::Relative(0.5);

/// Gaussian kernel regression with a kernel on each of so many samples or, of more than
/// [`RegressorConfig::CANDIDATES`], on as many of them.
fn kernel_regression(samples: usize) -> RegressorConfig {
    if samples <= RegressorConfig::CANDIDATES {
        RegressorConfig::KernelRidge(KernelRidge { bandwidth: WIDTH, ..KernelRidge::default() })
    } else {
        nystrom()
    }
}

/// Gaussian kernel regression on many samples.
pub(crate) fn nystrom() -> RegressorConfig {
    RegressorConfig::Nystrom(NystromRidge { bandwidth: WIDTH, ..NystromRidge::default() })
}

impl Predictor {
    /// Poses, 28 × T, of descriptors, K × T.
    pub(crate) fn predict(&self, x: MatRef<'_, f64>) -> Result<Mat<f64>> {
        Ok(match self {
            Self::Model(model) => model.predict(x)?,
            Self::Nearest(train) => nearest_mean(train.x.as_ref(), train.y.as_ref(), x, 5),
            Self::Mean(mean) => Mat::from_fn(mean.nrows(), x.ncols(), |row, _| mean[(row, 0)]),
        })
    }

    /// How many training samples it keeps; of a linear model, none.
    pub(crate) fn kept_samples(&self) -> usize {
        match self {
            Self::Model(model) => model.kept_samples().len(),
            Self::Nearest(train) => train.x.ncols(),
            Self::Mean(_) => 0,
        }
    }
}
