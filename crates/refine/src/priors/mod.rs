//! What is known before looking at boundaries: of the pose, of the hand and of the cameras.

pub(crate) mod gaussian;
pub(crate) mod nuisance;
pub(crate) mod pose;
