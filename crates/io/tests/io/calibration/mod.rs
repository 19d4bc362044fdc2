//! Calibrations of every tool, read and refused.

mod forms;
mod reference;
mod refusals;
mod tools;
mod written;
