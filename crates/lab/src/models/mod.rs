//! The models that the segmentation crate ships, and how they are trained.

mod drawn_hand;
pub(crate) mod end_model;
pub(crate) mod skin_model;
pub(crate) mod wrist_model;
