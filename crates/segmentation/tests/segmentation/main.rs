//! What a user of the crate sees of masks and silhouettes.

mod auto_traits;
mod clean;
mod common;
mod contour;
mod downsample;
mod hands;
#[path = "../property/mod.rs"]
mod property;
mod silhouette;
mod skin;
mod walls_and_backgrounds;
