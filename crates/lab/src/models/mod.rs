//! The models that the segmentation crate ships, and how they are trained.

pub(crate) mod skin_model;
pub(crate) mod wrist_model;
