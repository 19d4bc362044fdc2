//! What the `phalanx` program and the experiments have in common: where results go, and the parts of a
//! training.

pub mod files;
pub mod parts;
