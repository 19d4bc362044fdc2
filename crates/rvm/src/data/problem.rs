//! Training data, checked and standardised.

use faer::{Mat, MatRef};

use crate::data::check;
use crate::data::scaler::StandardScaler;
use crate::error::Result;

/// Training data and the scaling that standardised them.
pub(crate) struct Problem {
    pub(crate) inputs: StandardScaler,
    pub(crate) targets: StandardScaler,
    /// Standardised inputs, K×I.
    pub(crate) z: Mat<f64>,
    /// Standardised targets, samples in rows: I×m.
    pub(crate) y: Mat<f64>,
}

impl Problem {
    pub(crate) fn new(x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Self> {
        Self::scaled(StandardScaler::fit(x)?, x, y)
    }

    /// The inputs keep their proportions.
    pub(crate) fn in_proportion(x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Self> {
        Self::scaled(StandardScaler::in_proportion(x)?, x, y)
    }

    /// The inputs are scaled as given.
    pub(crate) fn scaled(
        inputs: StandardScaler,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
    ) -> Result<Self> {
        check::matrix("y", y)?;
        check::length("columns (samples) of y", x.ncols(), y.ncols())?;
        let targets = StandardScaler::fit(y)?;
        let z = inputs.apply(x)?;
        let y = targets.apply(y)?.transpose().to_owned();
        Ok(Self { inputs, targets, z, y })
    }

    /// The inputs that vary.
    pub(crate) fn features(&self) -> Vec<usize> {
        self.inputs.varying()
    }
}
