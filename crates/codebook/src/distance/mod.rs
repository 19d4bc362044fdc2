//! How samples are compared: metrics, and their kernels over many vectors at once.

pub(crate) mod chi_squared;
pub(crate) mod chi_squared_kernel;
pub(crate) mod euclidean_kernel;
pub(crate) mod lanes;
pub(crate) mod metric;
pub(crate) mod packed;
pub(crate) mod support;
