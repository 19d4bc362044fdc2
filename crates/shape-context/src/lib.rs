#![doc = include_str!("../README.md")]

mod axis;
mod error;
mod grid;
mod orientation;
mod pairs;
mod points;
mod principal;
mod tangent;
mod workspace;

pub use axis::{Axis, hand_axis};
pub use error::{Error, Result};
pub use grid::{BINS, RINGS, SECTORS, ring_radii, sector_edges};
pub use orientation::{Chain, Orientation};
pub use points::{MAX_COORDINATE, MAX_POINTS, MIN_MEAN_DISTANCE, MIN_POINTS, mean_distance};
pub use workspace::{Descriptors, ShapeContexts};
