//! How fast the crates are, alone and beside their peers.

pub(crate) mod flat_memory;
pub(crate) mod peers;
pub(crate) mod performance;
pub(crate) mod scale;
