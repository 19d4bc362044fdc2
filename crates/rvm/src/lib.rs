#![doc = include_str!("../README.md")]

mod bridges;
mod cascade;
mod check;
mod error;
mod forward;
mod kernel;
mod kernel_ridge;
mod linalg;
mod model;
mod penalised;
mod problem;
mod report;
mod ridge;
mod standardiser;
mod tipping;

pub use bridges::{Bridges, Stop};
pub use cascade::Cascade;
pub use error::{Error, Result};
pub use faer;
pub use forward::ForwardSelection;
pub use kernel::{Kernel, Width};
pub use kernel_ridge::{KernelRidge, Lambda};
pub use model::{Basis, Factor, Model, ModelParts, Posterior, Scratch};
pub use report::{Fit, Report, Trace};
pub use ridge::Ridge;
pub use standardiser::Standardiser;
pub use tipping::Tipping;
