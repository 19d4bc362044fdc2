//! Training data: checked, scaled, subsampled.

pub(crate) mod check;
pub(crate) mod problem;
pub(crate) mod scaler;
pub(crate) mod size;
