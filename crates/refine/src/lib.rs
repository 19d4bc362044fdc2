#![doc = include_str!("../README.md")]

mod bundle;
mod error;
mod geometry;
mod observation;
mod pose_fit;
mod posture_search;
mod priors;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod solver;

pub use bundle::{Calibrated, Calibration, CalibrationFrame};
pub use error::{Error, Result};
pub use observation::silhouette::Evidence;
pub use pose_fit::agreement::Agreement;
pub use pose_fit::border_noise::{BorderNoise, BorderResiduals};
pub use pose_fit::fit::Refined;
pub use pose_fit::posterior::Posterior;
pub use pose_fit::screening::Screened;
pub use pose_fit::settings::{Level, Refinement};
pub use priors::nuisance::{CameraDoubt, Doubt, HandDoubt, Moves};
pub use priors::pose::PosePrior;
