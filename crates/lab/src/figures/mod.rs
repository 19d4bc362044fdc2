//! Charts and pictures.

pub(crate) mod chart;
pub(crate) mod mosaic;
pub(crate) mod photograph;
pub(crate) mod pictures;
pub(crate) mod plate;
