//! The methods that the table compares.

use clap::ValueEnum;
use phalanx::RegressorConfig;
use phalanx_rvm::{
    AgarwalTriggs, Kernel, KernelRidge, OrthogonalLeastSquares, RelevanceVectorMachine, Stop,
    TwoStageSelection,
};

/// How many columns each of the paper's methods keeps.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) lin_features: usize,
    pub(crate) gauss_samples: usize,
    pub(crate) both_features: usize,
    pub(crate) both_samples: usize,
}

impl Counts {
    /// The counts of the paper's Table 1 (and Figs. 9–11 where it leaves a cell empty); an
    /// outside trajectory takes those of `complex`.
    pub(crate) fn paper(views: usize, data_set: &str) -> Self {
        let (lin_features, gauss_samples, both_features, both_samples) = match (views, data_set) {
            (1, "open-close") => (3, 10, 13, 29),
            (_, "open-close") => (2, 10, 12, 29),
            (1, _) => (31, 42, 35, 38),
            (_, _) => (31, 41, 34, 38),
        };
        Self { lin_features, gauss_samples, both_features, both_samples }
    }

    /// The same, but no more samples than there are.
    pub(crate) fn at_most(self, samples: usize) -> Self {
        Self {
            gauss_samples: self.gauss_samples.min(samples),
            both_samples: self.both_samples.min(samples),
            ..self
        }
    }
}

/// A row's method.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum Method {
    /// Column-wise bridges, linear: features are selected.
    Lin,
    /// Column-wise bridges, Gaussian: samples are selected.
    Gauss,
    /// Features selected linearly, then samples by Gaussian kernels.
    Both,
    /// Gaussian, samples selected by orthogonal forward selection.
    Forward,
    /// Tipping's relevance vector machine for each output, linear.
    TippingLin,
    /// Dense Gaussian kernel ridge regression.
    KernelRidge,
    /// The mean of the five nearest neighbours, which fits nothing.
    #[value(skip)]
    Knn5,
}

impl Method {
    /// Those that select a number of columns that can be asked for.
    pub(crate) const COUNTED: [Self; 4] = [Self::Lin, Self::Gauss, Self::Both, Self::Forward];
    /// Those that do not.
    pub(crate) const UNCOUNTED: [Self; 3] = [Self::TippingLin, Self::KernelRidge, Self::Knn5];

    /// The name in tables and JSON.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Lin => "lin",
            Self::Gauss => "gauss",
            Self::Both => "both",
            Self::Forward => "forward",
            Self::TippingLin => "tipping_lin",
            Self::KernelRidge => "kernel_ridge",
            Self::Knn5 => "knn5",
        }
    }

    /// The regressor with these counts; `None` for nearest neighbours, which fit nothing.
    pub(crate) fn regressor(self, counts: Counts) -> Option<RegressorConfig> {
        let gaussian = AgarwalTriggs::default().kernel;
        Some(match self {
            Self::Lin => RegressorConfig::Bridges(AgarwalTriggs {
                kernel: Kernel::Linear,
                stop: Stop::Count(counts.lin_features),
                ..AgarwalTriggs::default()
            }),
            Self::Gauss => RegressorConfig::Bridges(AgarwalTriggs {
                kernel: gaussian,
                stop: Stop::Count(counts.gauss_samples),
                ..AgarwalTriggs::default()
            }),
            Self::Both => RegressorConfig::Cascade(TwoStageSelection {
                features: Stop::Count(counts.both_features),
                samples: Stop::Count(counts.both_samples),
                ..TwoStageSelection::default()
            }),
            Self::Forward => RegressorConfig::Forward(OrthogonalLeastSquares {
                kernel: gaussian,
                count: counts.gauss_samples,
                ..OrthogonalLeastSquares::default()
            }),
            Self::TippingLin => RegressorConfig::Tipping(RelevanceVectorMachine {
                kernel: Kernel::Linear,
                ..RelevanceVectorMachine::default()
            }),
            Self::KernelRidge => RegressorConfig::KernelRidge(KernelRidge::default()),
            Self::Knn5 => return None,
        })
    }
}
