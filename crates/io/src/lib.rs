#![doc = include_str!("../README.md")]

pub mod calibration;
mod commas;
mod error;
pub mod evaluation;
pub mod export;
pub mod landmarks;
mod model;
mod npy;
pub mod page;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
pub mod report;
mod source;
pub mod take;

pub use error::{Error, Result};
pub use source::Source;
