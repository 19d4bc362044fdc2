//! What a user of the crate sees of lenses, cameras and rigs.

mod auto_traits;
mod properties;
#[path = "../property/mod.rs"]
mod property;
mod rig;
