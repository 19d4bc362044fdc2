#![doc = include_str!("../README.md")]

mod agreement;
mod border_noise;
mod calibration;
mod doubt;
mod error;
mod evidence;
mod fit;
mod hull;
mod posterior;
mod prior;
mod problem;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod proportions;
mod refinement;
mod screen;
mod search;
mod system;
mod touching;
mod view;

pub use agreement::Agreement;
pub use border_noise::{BorderNoise, BorderResiduals};
pub use calibration::{Calibrated, Calibration, CalibrationFrame};
pub use doubt::{CameraDoubt, HandDoubt, Moves};
pub use error::{Error, Result};
pub use evidence::Evidence;
pub use posterior::Posterior;
pub use prior::PosePrior;
pub use refinement::{Doubt, Level, Refined, Refinement};
pub use screen::Screened;
