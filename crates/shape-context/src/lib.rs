#![doc = include_str!("../README.md")]

mod assignment;
mod axis;
mod bilinear;
mod error;
mod forearm;
mod grid;
mod matching;
mod orientation;
mod pairs;
mod points;
mod principal;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod resample;
mod tangent;
mod workspace;

pub use axis::{Axis, hand_axis};
pub use error::{Error, Result};
pub use forearm::{ForearmAxis, forearm_axis};
pub use grid::{BINS, RINGS, SECTORS, ring_radii, sector_edges};
pub use matching::{MAX_MATCHED, Matcher, Matching};
pub use orientation::{Chain, Orientation};
pub use points::{MAX_COORDINATE, MAX_POINTS, MIN_MEAN_DISTANCE, MIN_POINTS, mean_distance};
pub use resample::resample;
pub use workspace::{Binning, Descriptors, ShapeContexts};
