#![doc = include_str!("../README.md")]

mod bridges;
mod cascade;
mod check;
mod columns;
mod design;
mod equations;
mod error;
mod forward;
mod kernel;
mod kernel_ridge;
mod linalg;
mod model;
mod nystrom;
mod penalised;
mod problem;
mod report;
mod ridge;
mod standardiser;
mod sums;
mod tipping;

pub use bridges::{Bridges, Stop};
pub use cascade::Cascade;
pub use columns::{Columns, Pilot};
pub use error::{Error, Result};
pub use faer;
pub use forward::ForwardSelection;
pub use kernel::{Kernel, Width};
pub use kernel_ridge::{KernelRidge, Lambda};
pub use model::{Basis, Factor, Model, ModelParts, Posterior, Scratch};
pub use nystrom::{Nystrom, Penalty};
pub use report::{Fit, Report, Trace};
pub use ridge::Ridge;
pub use standardiser::Standardiser;
pub use sums::{Sums, SumsParts};
pub use tipping::Tipping;
