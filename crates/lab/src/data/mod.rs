//! What is learnt from and tested on: drawn motion, splits, real photographs.

pub(crate) mod data_set;
pub(crate) mod described;
pub(crate) mod fixtures;
pub(crate) mod photographs;
pub(crate) mod postures;
pub(crate) mod saturation;
pub(crate) mod scene_list;
pub(crate) mod sets;
pub(crate) mod split;
pub(crate) mod trajectories;
