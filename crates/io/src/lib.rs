#![doc = include_str!("../README.md")]

pub mod calibration;
mod error;

pub use error::{Error, Result};
