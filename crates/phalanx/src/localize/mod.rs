//! Where the hand is in space, from what all cameras see.

mod arm;
mod associate;
mod crop;
mod detect;
pub(crate) mod exits;
pub(crate) mod global_pose;
pub(crate) mod sighting;

pub use arm::Arm;
pub use associate::{Placement, associate};
pub use crop::{BoundingSphere, HandCrop};
pub use detect::Detections;
pub(crate) use detect::{probability, unlikely};
