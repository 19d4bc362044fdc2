//! Calibrated cameras, read from the files of other tools.

use phalanx_camera::Camera;

/// Calibrated cameras, in millimetres and phalanx's conventions.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The cameras, in the file's order.
    pub cameras: Vec<Camera>,
    /// What was taken for granted or left out while reading, a sentence each.
    pub notes: Vec<String>,
}
