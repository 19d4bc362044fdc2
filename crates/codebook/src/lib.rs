#![doc = include_str!("../README.md")]

mod cluster;
mod codebook;
mod distance;
mod encode;
mod error;
mod limits;
mod samples;

pub use cluster::expectation_maximisation::ExpectationMaximisation;
pub use cluster::fixed_radius::FixedRadius;
pub use cluster::gaussian_mixture::{GaussianMixture, MixtureParts};
pub use cluster::kmeans::{Fit, KMeans, Report};
pub use cluster::mini_batch::MiniBatch;
pub use codebook::{Codebook, Nearest};
pub use distance::chi_squared::chi_squared;
pub use distance::metric::{Metric, squared_euclidean};
pub use encode::any::AnyEncoder;
pub use encode::encoder::Encoder;
pub use encode::fisher::Fisher;
pub use encode::scratch::Scratch;
pub use encode::soft_assignment::{SoftAssignment, SoftHistogram};
pub use encode::vlad::Vlad;
pub use error::{Error, Result};
pub use limits::{MAX_MAGNITUDE, SUM_TOLERANCE};
