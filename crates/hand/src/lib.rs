#![doc = include_str!("../README.md")]

mod chain;
mod csv_file;
mod dof;
mod error;
mod kinematics;
mod landmark;
mod pose;
mod primitive;
mod prior;
mod shape;
mod solids;
mod twist;
mod variation;

pub use csv_file::{PoseTable, write_poses};
pub use dof::{Digit, Dof, Unit};
pub use error::{Error, Result};
pub use kinematics::{JOINTS, PosedHand};
pub use landmark::{Landmark, Landmarks};
pub use pose::{Pose, abduction_limit, may_be_radians};
pub use primitive::{Primitive, Sphere};
pub use prior::{sample_pose, sample_pose_independent, sample_posture};
pub use shape::{FingerShape, ForearmShape, HandShape, PalmShape, Side, ThumbShape};
pub use twist::{Bone, Twist, Twists};
pub use variation::Measure;
