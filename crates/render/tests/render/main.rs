//! Pictures against slow and obvious ways to get them.

mod clipped;
mod pictures;
mod silhouette;
mod strategies;
