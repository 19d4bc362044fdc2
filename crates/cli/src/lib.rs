//! What the `phalanx` program and the experiments have in common: how files are read, where results go, and
//! the parts of a training.

pub mod files;
pub mod parts;
pub mod reading;
