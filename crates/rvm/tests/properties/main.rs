//! Properties that every fitter must have, and each one's difference from a slow and obvious one.

mod auto_traits;
mod bad_input;
mod bridges;
mod conditional;
mod deviations;
mod equivariance;
mod export;
mod forward;
mod healed;
mod kernel_ridge;
mod learnt_widths;
mod metric;
mod multivariate;
mod nystrom;
mod parts;
mod perceptron;
mod problems;
#[path = "../property/mod.rs"]
mod property;
mod sampling;
mod streams;
mod tipping;
mod torture;
