//! Pictures against slow and obvious ways to get them.

mod pictures;
mod silhouette;
mod strategies;
