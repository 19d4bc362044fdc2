#![doc = include_str!("../README.md")]

mod detect;
mod error;
mod mask;
mod masking;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod silhouette;

pub use detect::detector::{HandDetection, HandDetector};
pub use detect::end_model::{EndModel, EndParts};
pub use detect::wrist_model::WristModel;
pub use detect::wrist_trainer::WristTrainer;
pub use error::{Error, Result};
pub use mask::Mask;
pub use mask::cleanup::{Cleanup, Workspace, clean, clean_into};
pub use mask::resample::{CropWindow, downsample, downsample_mask};
pub use masking::adapted_skin::AdaptedSkin;
pub use masking::background::{BackgroundModel, BackgroundParams, BackgroundParts};
pub use masking::chroma::chroma;
pub use masking::label::Label;
pub use masking::plain_background::PlainBackground;
pub use masking::scene::SceneModel;
pub use masking::segment::Segment;
pub use masking::skin::{BUILTIN_SOURCE, SkinModel, SkinParams, SkinParts, SkinTrainer};
pub use silhouette::contour::Contour;
pub use silhouette::extraction::{MIN_SIDE, Silhouette};
pub use silhouette::forearm::{Forearm, ForearmCue};
