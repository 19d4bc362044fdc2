//! How models are trained.

pub(crate) mod merge;
pub(crate) mod preset_name;
pub(crate) mod train;
