//! The energy of a fit, its normal equations, and the descent.

pub(crate) mod jacobian;
pub(crate) mod landmark_residuals;
pub(crate) mod levenberg_marquardt;
pub(crate) mod loss;
pub(crate) mod matched_frame;
pub(crate) mod normal_equations;
pub(crate) mod problem;
pub(crate) mod residuals;
