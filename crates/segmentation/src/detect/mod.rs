//! Where a hand is in the mask of an arm: shape across the arm, from its end to its tip.

pub(crate) mod cross_sections;
pub(crate) mod detector;
pub(crate) mod end_model;
pub(crate) mod gaussian;
pub(crate) mod geodesic;
pub(crate) mod grid;
pub(crate) mod wrist_model;
pub(crate) mod wrist_trainer;
