//! How far cameras are from each other: what a wrong unit shows first.

use phalanx_camera::Camera;

use crate::error::{Error, Result};

/// Nearer than this, or farther than that, no two cameras of a hand's rig are, mm.
const NEAREST_MM: f64 = 20.0;
const FARTHEST_MM: f64 = 20_000.0;

/// Two cameras and the distance between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Distance {
    /// One camera's name.
    pub first: String,
    /// The other's.
    pub second: String,
    /// Between their centres, mm.
    pub mm: f64,
}

/// The distances from each camera to the next.
pub fn camera_distances(cameras: &[Camera]) -> Vec<Distance> {
    let between = |pair: &[Camera]| Distance {
        first: pair[0].name.clone(),
        second: pair[1].name.clone(),
        mm: pair[0].centre().distance(pair[1].centre()),
    };
    cameras.windows(2).map(between).collect()
}

/// Refuses distances that no rig has.
pub(super) fn check(cameras: &[Camera]) -> Result<()> {
    for (index, first) in cameras.iter().enumerate() {
        for second in &cameras[..index] {
            let mm = first.centre().distance(second.centre());
            if !(NEAREST_MM..=FARTHEST_MM).contains(&mm) {
                let (first, second) = (second.name.clone(), first.name.clone());
                return Err(Error::CalibrationDistance { first, second, mm });
            }
        }
    }
    Ok(())
}
