//! Scenes that are drawn to learn from.

pub(crate) mod augmentation;
pub(crate) mod postures;
pub(crate) mod rng;
pub(crate) mod sampler;
pub(crate) mod scene;
pub(crate) mod scene_describer;
