#![doc = include_str!("../README.md")]

mod checking;
mod error;
mod estimator;
mod features;
mod fit_chances;
mod fitting;
mod images;
mod localize;
mod losses;
mod progress;
#[cfg(test)]
#[path = "../tests/property/mod.rs"]
mod property;
mod refiner;
mod restarts;
mod synthesis;
mod training;
mod view_set;
mod window;

pub use checking::doubt::{Cause, ViewDoubt};
pub use checking::usual::UsualExplanation;
pub use error::{Error, Result};
pub use estimator::answering::Workspace;
pub use estimator::error_model::ErrorModel;
pub use estimator::estimate::Estimate;
pub use estimator::hypotheses::Hypothesis;
pub use estimator::model::Estimator;
pub use estimator::observation::{Observation, ObservedView};
pub use estimator::placement::PlacementErrors;
pub use estimator::refined_errors::RefinedErrors;
pub use estimator::regression::FittedRegressor;
pub use features::describer::{
    Describer, OrientationRule, ViewConfig, WORKING_SIZE, working_camera,
};
pub use features::descriptor::{Descriptor, ExtraFeatures, describe_scenes};
pub use features::samples::{descriptors, targets};
pub use fitting::{
    Delay, FitDoubt, FrameFit, LandmarkFit, Missing, Proportions, TakeFit, TakeFrame, TakeSettings,
    TrackSettings, TrackedFrame, Tracker, TrackerState, ViewFit, VolumeEstimate, estimate_volume,
    fit_frame, fit_take, trusted_volume,
};
pub use images::decode::decode_picture;
pub use images::overlay::{draw_overlay, draw_window_overlay, working_window};
pub use images::picture::{Picture, Segmenter, mask_from, photograph_from};
pub use images::segmentation_file::Segmentation;
pub use localize::global_pose::{GlobalStart, initial_global};
pub use localize::{Arm, BoundingSphere, Detections, HandCrop, Placement, associate};
pub use losses::{LossReason, Losses};
pub use phalanx_segmentation::{Mask, Segment};
pub use progress::{NoProgress, Progress};
pub use refiner::{RefinedEstimate, Refiner};
pub use synthesis::augmentation::{Augmentation, MaskNoise, ShapeVariation};
pub use synthesis::rng::ItemRng;
pub use synthesis::sampler::{PoseSource, SampledScenes, SceneSampler};
pub use synthesis::scene::{FixedPoses, Scene, SceneSource, SceneSubset, SceneView};
pub use synthesis::scene_describer::{
    PoseContexts, SceneDescriber, describe_each, draw_mask, draw_silhouette,
};
pub use training::cameras::Cameras;
pub use training::learnt_metric::LearntMetric;
pub use training::maker::Maker;
pub use training::network_training::NetworkTraining;
pub use training::partial::PartialTraining;
pub use training::preset::Preset;
pub use training::recipe::{Encoding, Training};
pub use training::regressor::RegressorConfig;
pub use training::shard::Shard;
pub use training::trainer::{Cost, Trainer};
pub use window::{Framing, PicturedHand, Window, WindowFinder};
