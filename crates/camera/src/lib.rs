#![doc = include_str!("../README.md")]

mod camera;
mod distortion;
mod error;
mod extrinsics;
mod file;
mod intrinsics;
mod rig;
mod volume;

pub use camera::{Camera, Ray};
pub use distortion::Distortion;
pub use error::{Error, Result};
pub use extrinsics::Extrinsics;
pub use intrinsics::Intrinsics;
pub use rig::Rig;
pub use volume::Volume;
