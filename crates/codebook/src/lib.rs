#![doc = include_str!("../README.md")]

mod chi_squared;
mod codebook;
mod coding;
mod error;
mod kmeans;
mod lloyd;
mod packed;
mod samples;
mod seeding;
mod vlad;
mod voting;

pub use chi_squared::chi_squared;
pub use codebook::{Codebook, Nearest};
pub use coding::{AnyCoding, Coding};
pub use error::{Error, Result};
pub use kmeans::{Fit, KMeans, Report};
pub use samples::SUM_TOLERANCE;
pub use vlad::Vlad;
pub use voting::{Scratch, SoftCounts, Voting};
