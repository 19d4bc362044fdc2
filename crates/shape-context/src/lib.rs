#![doc = include_str!("../README.md")]

mod axis;
mod error;
mod forearm;
mod grid;
mod orientation;
mod pairs;
mod points;
mod principal;
mod resample;
mod tangent;
mod workspace;

pub use axis::{Axis, hand_axis};
pub use error::{Error, Result};
pub use forearm::{ForearmAxis, forearm_axis};
pub use grid::{BINS, RINGS, SECTORS, ring_radii, sector_edges};
pub use orientation::{Chain, Orientation};
pub use points::{MAX_COORDINATE, MAX_POINTS, MIN_MEAN_DISTANCE, MIN_POINTS, mean_distance};
pub use resample::resample;
pub use workspace::{Descriptors, ShapeContexts};
