//! What regressions are compared with.

pub(crate) mod neighbours;
pub(crate) mod principal_axes;
