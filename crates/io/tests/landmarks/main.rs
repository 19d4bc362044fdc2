//! Landmarks of a detector, as each tool writes them.

#[path = "../property/mod.rs"]
mod property;

mod forms;
mod refusals;
mod tools;
