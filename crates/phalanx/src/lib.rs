#![doc = include_str!("../README.md")]

mod describe;
mod error;
mod estimator;
mod model_file;
mod outline;
mod overlay;
mod picture;
mod progress;
mod training;
mod training_views;

pub use describe::{Describer, OrientationRule, WORKING_SIZE, working_camera};
pub use error::{Error, Result};
pub use estimator::{Estimate, Estimator, Workspace};
pub use overlay::{draw_overlay, working_window};
pub use picture::{Picture, Segmenter};
pub use progress::{Progress, Silent};
pub use training::{Regressor, Training, descriptors, targets};
pub use training_views::{PoseContexts, describe_each_pose, describe_poses, draw_silhouette};

/// The example of the repository's README, which must compile.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct RepositoryReadme;
