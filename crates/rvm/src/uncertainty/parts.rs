//! The plain numbers of a conditional density, and the check that they fit together.

use crate::data::check;
use crate::error::{Error, Result};
use crate::uncertainty::ConditionalDensity;

/// Everything that a [`ConditionalDensity`] is made of.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ConditionalDensityParts {
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

impl ConditionalDensity {
    /// Puts one together from its parts, checked against each other.
    pub fn from_parts(parts: ConditionalDensityParts) -> Result<Self> {
        parts.check()?;
        Ok(Self { parts })
    }

    /// Its parts.
    pub fn into_parts(self) -> ConditionalDensityParts {
        self.parts
    }

    /// A look at the parts.
    pub fn parts(&self) -> &ConditionalDensityParts {
        &self.parts
    }
}

impl ConditionalDensityParts {
    fn check(&self) -> Result<()> {
        let samples = self.predictions.len().checked_div(self.outputs).unwrap_or(0);
        fault("outputs", "must be at least 1", self.outputs == 0)?;
        fault(
            "neighbours",
            "must be from 1 to the samples",
            !(1..=samples).contains(&self.neighbours),
        )?;
        fault("units", "has the wrong length", self.units.len() != self.outputs)?;
        fault("units", "must be above 0", !self.units.iter().all(|&unit| unit > 0.0))?;
        let whole = samples.checked_mul(self.outputs) == Some(self.predictions.len());
        fault("predictions", "has the wrong length", !whole)?;
        let lengths_differ = self.residuals.len() != self.predictions.len();
        fault("residuals", "has the wrong length", lengths_differ)?;
        for (field, values) in [
            ("units", &self.units),
            ("predictions", &self.predictions),
            ("residuals", &self.residuals),
        ] {
            let unusable = !values.iter().all(|&v| check::usable(v));
            fault(field, "holds an unusable number", unusable)?;
        }
        Ok(())
    }
}

impl TryFrom<ConditionalDensityParts> for ConditionalDensity {
    type Error = Error;

    fn try_from(parts: ConditionalDensityParts) -> Result<Self> {
        Self::from_parts(parts)
    }
}

impl From<ConditionalDensity> for ConditionalDensityParts {
    fn from(density: ConditionalDensity) -> Self {
        density.into_parts()
    }
}

fn fault(field: &'static str, problem: &'static str, present: bool) -> Result<()> {
    if present { Err(Error::Parts { field, problem }) } else { Ok(()) }
}
