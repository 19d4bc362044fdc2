#![doc = include_str!("../README.md")]

pub mod calibration;
mod error;
pub mod export;
mod model;
pub mod take;

pub use error::{Error, Result};
