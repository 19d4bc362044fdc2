//! One frame: a pose fitted to what cameras saw, and what can be said of a fit.

pub(crate) mod agreement;
pub(crate) mod boundary_noise;
pub(crate) mod fit;
pub(crate) mod fitted_nuisance;
pub(crate) mod landmark_noise;
pub(crate) mod near;
pub(crate) mod posterior;
pub(crate) mod posture_variance;
pub(crate) mod screening;
pub(crate) mod settings;
