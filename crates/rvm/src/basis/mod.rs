//! Basis functions, and the normal equations over them.

pub(crate) mod design;
mod gaussians;
pub(crate) mod kernel;
pub(crate) mod normal_equations;
pub(crate) mod spec;
