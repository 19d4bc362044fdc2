#![doc = include_str!("../README.md")]

mod basis;
mod container;
mod coverage;
mod damage;
mod decode;
mod describe;
mod descriptor;
mod error;
mod estimator;
mod fitting;
mod gathered;
mod global_pose;
mod hypotheses;
mod localize;
mod losses;
mod model_file;
mod observation;
mod outline;
mod overlay;
mod part;
mod picture;
mod preset;
mod progress;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod random;
mod refiner;
mod regression;
mod regressor;
mod restarts;
mod scene;
mod shard;
mod sighting;
mod synthesis;
mod trainer;
mod training;
mod training_views;
mod window;

pub use damage::{Border, Damage, Hands};
pub use decode::decode_picture;
pub use describe::{Describer, OrientationRule, Sight, WORKING_SIZE, working_camera};
pub use descriptor::{Beside, Descriptor, describe_scenes};
pub use error::{Error, Result};
pub use estimator::{Estimate, Estimator, Workspace};
pub use fitting::{
    FitDoubt, FrameFit, Missing, Proportions, TakeFit, TakeFrame, TakeSettings, ViewFit,
    VolumeEstimate, estimate_volume, fit_frame, fit_take,
};
pub use global_pose::{GlobalStart, initial_global};
pub use hypotheses::Hypothesis;
pub use localize::{Arm, Ball, Detections, HandCrop, Placement, associate};
pub use losses::{LossReason, Losses};
pub use observation::{Observation, ObservedView};
pub use overlay::{draw_overlay, draw_window_overlay, working_window};
pub use part::Part;
pub use picture::{Picture, Segmenter};
pub use preset::Preset;
pub use progress::{Progress, Silent};
pub use random::ItemRandom;
pub use refiner::{RefinedEstimate, Refiner};
pub use regression::Regression;
pub use regressor::{LearntMetric, NetworkTraining, Regressor};
pub use scene::{NominalScenes, Scene, SceneSubset, Scenes, View};
pub use shard::Shard;
pub use synthesis::{PoseSource, SampledScenes, SceneSampler};
pub use trainer::{Cost, Trainer};
pub use training::{Description, Training, descriptors, targets};
pub use training_views::{PoseContexts, SceneDescriber, describe_each, draw_silhouette};
pub use window::{Framing, Window, WindowFinder};
