//! Evaluations on drawn hands.

pub(crate) mod ablation;
pub(crate) mod doubts;
pub(crate) mod global_pose;
pub(crate) mod held_out;
pub(crate) mod hypotheses;
pub(crate) mod orientation;
pub(crate) mod presets;
pub(crate) mod refining;
pub(crate) mod reliability;
pub(crate) mod seen;
pub(crate) mod selection;
pub(crate) mod subsets;
pub(crate) mod table1;
pub(crate) mod tracking;
