//! The plain numbers of a conditional density, and the check that they fit together.

use crate::data::check;
use crate::error::Result;

/// Everything that a [`ResidualKde`](crate::ResidualKde) is made of.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ResidualKdeParts {
    /// Length m of a target vector.
    pub outputs: usize,
    /// Samples that speak for a prediction near them.
    pub neighbours: usize,
    /// What counts as 1 in each target.
    pub units: Vec<f64>,
    /// Predictions of n samples, m numbers each, one sample after the other.
    pub predictions: Vec<f64>,
    /// Targets less predictions, likewise.
    pub residuals: Vec<f64>,
}

impl ResidualKdeParts {
    pub(crate) fn check(&self) -> Result<()> {
        let samples = self.predictions.len().checked_div(self.outputs).unwrap_or(0);
        check::part("outputs", "must be at least 1", self.outputs == 0)?;
        check::part(
            "neighbours",
            "must be from 1 to the samples",
            !(1..=samples).contains(&self.neighbours),
        )?;
        check::part("units", "has the wrong length", self.units.len() != self.outputs)?;
        check::part("units", "must be above 0", !self.units.iter().all(|&unit| unit > 0.0))?;
        let whole = samples.checked_mul(self.outputs) == Some(self.predictions.len());
        check::part("predictions", "has the wrong length", !whole)?;
        let lengths_differ = self.residuals.len() != self.predictions.len();
        check::part("residuals", "has the wrong length", lengths_differ)?;
        for (field, values) in [
            ("units", &self.units),
            ("predictions", &self.predictions),
            ("residuals", &self.residuals),
        ] {
            let unusable = !values.iter().all(|&v| check::usable(v));
            check::part(field, "holds an unusable number", unusable)?;
        }
        Ok(())
    }
}
