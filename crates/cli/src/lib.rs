//! What the `phalanx` program and the experiments have in common: where results go.

pub mod files;
