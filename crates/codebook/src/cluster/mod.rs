//! How the words of a codebook are learnt.

pub(crate) mod expectation_maximisation;
pub(crate) mod fixed_radius;
pub(crate) mod gaussian_mixture;
pub(crate) mod kmeans;
pub(crate) mod lloyd;
pub(crate) mod mini_batch;
pub(crate) mod seeding;
