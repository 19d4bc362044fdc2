#![doc = include_str!("../README.md")]

mod background;
mod chroma;
mod clean;
mod components;
mod contour;
mod downsample;
mod error;
mod forearm;
mod gaussian;
mod geodesic;
mod grid;
mod hand_finder;
mod majority;
mod otsu;
mod sections;
mod silhouette;
mod skin;
mod skin_file;
mod stump;
mod wall;
mod wrist;

pub use background::{BackgroundModel, BackgroundParams, BackgroundParts};
pub use chroma::chroma;
pub use clean::{Cleanup, Workspace, clean, clean_into};
pub use contour::Contour;
pub use downsample::{CropWindow, downsample, downsample_mask};
pub use error::{Error, Result};
pub use forearm::{Evidence, Forearm};
pub use hand_finder::{HandFinder, LocatedHand};
pub use silhouette::{MIN_SIDE, Silhouette};
pub use skin::{BUILTIN_SOURCE, Label, SkinModel, SkinParams, SkinParts, SkinTrainer};
pub use wall::Wall;
pub use wrist::{WristModel, WristTrainer};
