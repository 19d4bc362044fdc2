//! Landmarks of a detector, as each tool writes them.

mod forms;
mod refusals;
mod tools;
