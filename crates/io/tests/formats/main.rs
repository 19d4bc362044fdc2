//! Takes: their three forms, what is refused, and the files of other tools.

mod exports;
mod forms;
#[path = "../property/mod.rs"]
mod property;
mod refusals;
mod sample;
mod schema;
mod strategies;
