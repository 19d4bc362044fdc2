//! From a silhouette to the numbers that a regressor reads.

pub(crate) mod describer;
pub(crate) mod descriptor;
pub(crate) mod occupancy;
pub(crate) mod outline;
pub(crate) mod samples;
