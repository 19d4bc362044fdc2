#![doc = include_str!("../README.md")]

mod assignment;
mod axis;
mod bilinear;
mod chain;
mod error;
mod forearm;
mod grid;
mod limits;
mod matching;
mod mean_distance;
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
pub use chain::Chain;
pub use error::{Error, Result};
pub use forearm::{ForearmAxis, forearm_axis};
pub use grid::{BINS, RINGS, SECTORS, ring_radii, sector_edges};
pub use limits::{MAX_COORDINATE, MAX_MATCHED, MAX_POINTS, MIN_MEAN_DISTANCE, MIN_POINTS};
pub use matching::{Matcher, Matching};
pub use mean_distance::mean_distance;
pub use orientation::Orientation;
pub use resample::resample;
pub use workspace::{Binning, Descriptors, ShapeContexts};
