//! Relevance vector machines.

pub(crate) mod ard;
pub(crate) mod augmented;
pub(crate) mod marginal_likelihood;
pub(crate) mod multi_output;
pub(crate) mod single;
