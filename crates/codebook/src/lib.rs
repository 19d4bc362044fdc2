#![doc = include_str!("../README.md")]

mod chi_squared;
mod codebook;
mod coding;
mod error;
mod expectation_maximisation;
mod fisher;
mod fixed_radius;
mod gaussian_mixture;
mod kmeans;
mod lloyd;
mod metric;
mod mini_batch;
mod packed;
mod samples;
mod scratch;
mod seeding;
mod support;
mod vlad;
mod voting;

pub use chi_squared::chi_squared;
pub use codebook::{Codebook, Nearest};
pub use coding::{AnyCoding, Coding};
pub use error::{Error, Result};
pub use expectation_maximisation::ExpectationMaximisation;
pub use fisher::Fisher;
pub use fixed_radius::FixedRadius;
pub use gaussian_mixture::{GaussianMixture, MixtureParts};
pub use kmeans::{Fit, KMeans, Report};
pub use metric::{Metric, squared_euclidean};
pub use mini_batch::MiniBatch;
pub use samples::{MAX_MAGNITUDE, SUM_TOLERANCE};
pub use scratch::Scratch;
pub use vlad::Vlad;
pub use voting::{SoftCounts, Voting};
