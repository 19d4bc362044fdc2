//! What a user of the crate sees of hands, poses and their files.

mod auto_traits;
mod files;
mod kinematics;
mod prior;
#[path = "../property/mod.rs"]
mod property;
mod twist;
