//! A parametric human hand: 28-d pose, shape, kinematics and joint limits

mod primitive;

pub use primitive::{Ball, Primitive};
