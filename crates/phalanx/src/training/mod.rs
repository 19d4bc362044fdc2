//! From scenes to an estimator, whole or in shards.

pub(crate) mod cameras;
pub(crate) mod feature_transform;
pub(crate) mod learnt_metric;
pub(crate) mod maker;
pub(crate) mod network_training;
pub(crate) mod partial;
mod partial_file;
pub(crate) mod plan;
pub(crate) mod preset;
pub(crate) mod recipe;
pub(crate) mod refined_trials;
pub(crate) mod regressor;
pub(crate) mod samples;
pub(crate) mod shard;
pub(crate) mod statistics;
pub(crate) mod subsets;
pub(crate) mod trainer;
