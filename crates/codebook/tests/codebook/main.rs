//! What a user of the crate sees of codebooks and codes.

mod auto_traits;
mod euclidean;
mod gaussian_mixture;
mod histograms;
mod kmeans;
mod parts;
#[path = "../property/mod.rs"]
mod property;
mod soft_assignment;
mod vlad;
