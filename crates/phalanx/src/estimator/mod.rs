//! The fitted estimator, what it returns, and its file.

pub(crate) mod answering;
pub(crate) mod container;
pub(crate) mod error_model;
mod error_trials;
pub(crate) mod estimate;
pub(crate) mod expert;
pub(crate) mod hypotheses;
pub(crate) mod model;
pub(crate) mod model_file;
pub(crate) mod observation;
pub(crate) mod placement;
pub(crate) mod refined_errors;
pub(crate) mod regression;
mod seeing;
pub(crate) mod subset_regression;
