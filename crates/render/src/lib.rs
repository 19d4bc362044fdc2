#![doc = include_str!("../README.md")]

mod appearance;
mod clip;
mod error;
mod fill;
mod outline;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod renderer;
mod solid;
mod supersampling;
mod surface;

pub use appearance::{Appearance, Background};
pub use error::{Error, Result};
pub use renderer::{DepthMap, Renderer};
pub use supersampling::Supersampling;
