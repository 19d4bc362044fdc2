//! What a user of the crate sees of several views.

mod auto_traits;
mod combination;
#[path = "../property/mod.rs"]
mod property;
mod views;
