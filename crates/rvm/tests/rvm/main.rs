//! Properties that every fitter must have, and each one's difference from a slow and obvious one.

mod agarwal_triggs;
mod ard;
mod augmented;
mod auto_traits;
mod bad_input;
mod codegen;
mod deviations;
mod equivariance;
mod kernel_ridge;
mod learned_metric;
mod mlp;
mod multi_output;
mod nystrom_ridge;
mod orthogonal_least_squares;
mod parts;
mod problems;
#[path = "../property/mod.rs"]
mod property;
mod residual_kde;
mod sampling;
mod single_output;
mod streams;
mod torture;
