//! The fitted estimator, what it returns, and its file.

pub(crate) mod container;
pub(crate) mod error_model;
pub(crate) mod estimate;
pub(crate) mod expert;
pub(crate) mod model_file;
pub(crate) mod observation;
pub(crate) mod placement;
pub(crate) mod regression;
pub(crate) mod subset_regression;
