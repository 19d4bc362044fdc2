#![doc = include_str!("../README.md")]

mod camera;
mod error;
mod extrinsics;
mod file;
mod intrinsics;
mod lens;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod rig;
mod scale;
mod triangulate;
mod virtual_camera;
mod volume;

pub use camera::{Camera, Ray};
pub use error::{Error, Result};
pub use extrinsics::Extrinsics;
pub use intrinsics::Intrinsics;
pub use lens::{Distortion, Fisheye, Lens};
pub use rig::Rig;
pub use scale::{ViewAngle, ViewScale};
pub use triangulate::{Triangulation, triangulate};
pub use virtual_camera::PixelMap;
pub use volume::Volume;
