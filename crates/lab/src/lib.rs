//! The experiments of phalanx. `cargo xtask` starts them.

pub mod files;
pub mod mosaic;
pub mod progress;
pub mod real;
