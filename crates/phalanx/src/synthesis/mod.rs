//! Scenes that are drawn to learn from.

mod sampler;

pub use sampler::{PoseSource, SampledScenes, SceneSampler};
