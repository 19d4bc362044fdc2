//! How fast the crates are, alone and beside their peers.

pub(crate) mod cost;
pub(crate) mod flat_memory;
pub(crate) mod peers;
pub(crate) mod performance;
mod repeated;
pub(crate) mod scale;
