#![doc = include_str!("../README.md")]

mod calibration;
mod doubt;
mod error;
mod evidence;
mod fit;
mod hull;
mod prior;
mod problem;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod proportions;
mod refinement;
mod search;
mod system;
mod touching;
mod view;

pub use calibration::{Calibrated, Calibration, CalibrationFrame};
pub use doubt::{CameraDoubt, HandDoubt, Moves};
pub use error::{Error, Result};
pub use evidence::Evidence;
pub use prior::PosePrior;
pub use refinement::{Doubt, Level, Refined, Refinement};
