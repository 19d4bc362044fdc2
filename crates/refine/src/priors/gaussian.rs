//! What is known of one number: a Gaussian about 0.

/// What is known of a number: that it is 0 to a standard deviation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GaussianPenalty {
    pub(crate) energy: f64,
    pub(crate) gradient: f64,
    pub(crate) hessian: f64,
}

impl GaussianPenalty {
    pub(crate) fn new(value: f64, deviation: f64) -> Self {
        let hessian = deviation.powi(-2);
        Self { energy: 0.5 * value * value * hessian, gradient: value * hessian, hessian }
    }
}
