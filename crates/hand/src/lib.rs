#![doc = include_str!("../README.md")]

mod csv_file;
mod dof;
mod error;
mod kinematics;
mod motion;
mod pose;
mod primitive;
mod prior;
mod shape;
mod variation;

pub use csv_file::{PoseTable, write_poses};
pub use dof::{Digit, Dof, Unit};
pub use error::{Error, Result};
pub use kinematics::{JOINTS, PosedHand};
pub use motion::{Link, Motion, Motions};
pub use pose::{Pose, abduction_limit};
pub use primitive::{Ball, Primitive};
pub use prior::{coupled_pose, coupled_posture, uncoupled_pose};
pub use shape::{FingerShape, ForearmShape, HandShape, PalmShape, Side, ThumbShape};
