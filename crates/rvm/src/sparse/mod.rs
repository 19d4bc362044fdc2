//! Regressions that keep some of the columns.

pub(crate) mod agarwal_triggs;
pub(crate) mod orthogonal_least_squares;
pub(crate) mod two_stage;
