//! The experiments of phalanx: data, methods, scores, reports. `cargo xtask` starts them.

mod baselines;
mod bench;
mod child;
mod clock;
pub mod commands;
mod context;
mod data;
mod eval;
mod figures;
pub mod files;
mod memory;
mod metrics;
mod models;
mod page;
mod paper;
mod progress;
pub mod real;
mod recipes;
