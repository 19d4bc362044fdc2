//! Maps of the inputs that are learnt before a regression.

pub(crate) mod affine_map;
pub(crate) mod block_pca;
pub(crate) mod egop;
pub(crate) mod grouped;
pub(crate) mod learned_metric;
pub(crate) mod pca;
