#![doc = include_str!("../README.md")]

pub mod calibration;
mod error;
pub mod export;
mod model;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
pub mod take;

pub use error::{Error, Result};
