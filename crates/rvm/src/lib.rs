#![doc = include_str!("../README.md")]

mod basis;
mod data;
mod error;
mod linalg;
mod mlp;
mod model;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod ridge;
mod rvm;
mod sparse;
mod stream;
mod transform;
mod uncertainty;

pub use basis::kernel::{Bandwidth, Kernel};
pub use basis::spec::{BasisSpec, PilotSample};
pub use data::scaler::StandardScaler;
pub use data::size::ProblemSize;
pub use error::{Error, Result};
pub use faer;
pub use mlp::MlpTrainer;
pub use mlp::missing::{IncompleteFit, MissingInputs};
pub use mlp::network::{Mlp, MlpParts};
pub use mlp::pca_mlp::PcaMlp;
pub use model::Model;
pub use model::cholesky_factor::CholeskyFactor;
pub use model::parts::{Basis, ModelParts, Posterior};
pub use model::regressor::Regressor;
pub use model::report::{Fit, Progress, Report, Trace};
pub use model::scratch::Scratch;
pub use phalanx_sampling::random_subset;
pub use ridge::Ridge;
pub use ridge::kernel_ridge::{KernelRidge, Regularisation};
pub use ridge::nystrom::{NystromRegularisation, NystromRidge, PredictiveDeviation};
pub use rvm::ard::{ArdRvm, LengthScales};
pub use rvm::augmented::AugmentedRvm;
pub use rvm::multi_output::MultiOutputRvm;
pub use rvm::single::RelevanceVectorMachine;
pub use sparse::agarwal_triggs::{AgarwalTriggs, Stop};
pub use sparse::orthogonal_least_squares::OrthogonalLeastSquares;
pub use sparse::two_stage::TwoStageSelection;
pub use stream::SufficientStatistics;
pub use stream::parts::SufficientStatisticsParts;
pub use transform::affine_map::{AffineMap, AffineMapParts};
pub use transform::block_pca::BlockPca;
pub use transform::egop::ExpectedGradientOuterProduct;
pub use transform::grouped::GroupedRegressor;
pub use transform::learned_metric::{LearnedMetric, TargetGroup};
pub use transform::pca::FeatureBlock;
pub use uncertainty::parts::ResidualKdeParts;
pub use uncertainty::{Hypothesis, ResidualKde};
