//! What a user of the crate sees of shape contexts.

mod auto_traits;
mod axes;
mod bilinear;
mod errors;
mod invariance;
#[path = "../property/mod.rs"]
mod property;
mod reference;
mod resample;
mod star;
