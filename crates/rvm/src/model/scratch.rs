//! Working memory of predictions.

/// Working memory of single predictions. Create one with `default()` and reuse it; it grows at
/// first use.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    /// Standardised features.
    pub(crate) z: Vec<f64>,
    /// Centred basis columns.
    pub(crate) phi: Vec<f64>,
    /// The posterior's columns, and M times them.
    pub(crate) chosen: Vec<f64>,
    pub(crate) spread: Vec<f64>,
    /// A projection's input in single precision, and its output.
    pub(crate) single: Vec<f32>,
    pub(crate) projected: Vec<f64>,
    /// Principal components, and what goes into a network's next layer.
    pub(crate) components: Vec<f64>,
    pub(crate) hidden: Vec<f64>,
}

impl Scratch {
    /// The last prediction's standardised features.
    pub(crate) fn features(&self) -> &[f64] {
        &self.z
    }

    /// The last prediction's centred basis columns.
    pub(crate) fn columns(&self) -> &[f64] {
        &self.phi
    }
}
