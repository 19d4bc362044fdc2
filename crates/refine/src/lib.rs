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

pub use bundle::{BundleAdjustment, BundleFrame, BundleResult};
pub use error::{Error, Result};
pub use geometry::drawn_term::DrawnTerm;
pub use observation::evidence::Evidence;
pub use observation::landmarks::LandmarkObservation;
pub use observation::silhouette::SilhouetteObservation;
pub use pose_fit::agreement::Agreement;
pub use pose_fit::boundary_noise::{BoundaryNoise, BoundaryResiduals};
pub use pose_fit::fit::PoseFit;
pub use pose_fit::fitted_nuisance::FittedNuisance;
pub use pose_fit::landmark_noise::LandmarkNoise;
pub use pose_fit::posterior::Posterior;
pub use pose_fit::screening::Screened;
pub use pose_fit::settings::{Level, PoseFitSettings};
pub use priors::nuisance::{CameraMotion, ExtrinsicsPrior, NuisanceParameters, ShapePrior};
pub use priors::pose::PosePrior;
