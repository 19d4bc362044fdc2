//! Pictures against slow and obvious ways to get them.

mod auto_traits;
mod clipped;
mod pictures;
#[path = "../property/mod.rs"]
mod property;
mod silhouette;
mod strategies;
