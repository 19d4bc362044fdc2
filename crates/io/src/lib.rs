#![doc = include_str!("../README.md")]

pub mod calibration;
mod error;
pub mod evaluation;
pub mod export;
mod model;
pub mod page;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
pub mod report;
pub mod take;

pub use error::{Error, Result};
