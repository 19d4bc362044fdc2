//! What is known before looking at borders: of the pose, of the hand and of the cameras.

pub(crate) mod gaussian;
pub(crate) mod nuisance;
pub(crate) mod pose;
