//! Several weighted hypotheses around a prediction.

pub(crate) mod parts;
mod principal_points;

use faer::{Mat, MatRef};

use crate::data::check;
use crate::error::{Error, Result};
use crate::model::parts::known;
use crate::uncertainty::parts::ResidualKdeParts;
use crate::uncertainty::principal_points::PrincipalPoints;

/// The conditional density of the targets given a regressor's prediction.
///
/// The residuals of held-out samples whose predictions are nearest to ŷ(x) estimate how the targets
/// spread around ŷ(x): a kernel density estimate with the mean taken from the regressor (Hyndman,
/// Bashtannyk and Grunwald 1996). Do not use the samples that the regressor was fitted to: their
/// residuals are too small.
///
/// A few [`Hypothesis`] values summarise it: the prediction itself, and principal points (Flury
/// 1990), placed so that the nearest of them is as close as possible to the truth.
///
/// ```
/// use phalanx_rvm::{ResidualKde, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// // A regression that always says 0 where the truth is near −1 or near 1.
/// let predictions = Mat::zeros(1, 40);
/// let truth = Mat::from_fn(1, 40, |_, t| if t % 4 == 0 { -1.0 } else { 1.0 } + 0.001 * t as f64);
/// let density = ResidualKde::fit(predictions.as_ref(), truth.as_ref(), &[1.0], 40)?;
/// let answers = density.hypotheses(&[0.0], 3)?;
/// assert_eq!(answers[0].mean, [0.0], "the prediction comes first");
/// assert!((answers[1].mean[0] - 1.0).abs() < 0.1 && (answers[2].mean[0] + 1.0).abs() < 0.1);
/// assert!(answers[1].weight > 0.7);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "ResidualKdeParts", into = "ResidualKdeParts"))]
pub struct ResidualKde {
    parts: ResidualKdeParts,
}

/// One of several weighted answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Hypothesis {
    /// The m targets.
    pub mean: Vec<f64>,
    /// Standard deviation of each target among the residuals nearest to this hypothesis. If they
    /// are fewer than two or equal, the root mean square of all residuals nearby; infinite if these
    /// are all zero.
    pub std: Vec<f64>,
    /// Share of the residuals nearby that are nearest to this hypothesis. The weights sum to 1.
    pub weight: f64,
}

impl ResidualKde {
    /// Fits predictions, m×n, of held-out samples to their targets, m×n. The `neighbours` nearest
    /// samples are used for each prediction.
    ///
    /// `units` are the scales of the targets in distances, all above 0.
    pub fn fit(
        predictions: MatRef<'_, f64>,
        targets: MatRef<'_, f64>,
        units: &[f64],
        neighbours: usize,
    ) -> Result<Self> {
        check::matrix("predictions", predictions)?;
        check::matrix("targets", targets)?;
        check::length("rows of targets", predictions.nrows(), targets.nrows())?;
        check::length("columns (samples) of targets", predictions.ncols(), targets.ncols())?;
        check::length("units", predictions.nrows(), units.len())?;
        units.iter().try_for_each(|&unit| check::positive("unit", unit))?;
        within("neighbours", neighbours, predictions.ncols(), "from 1 to the number of samples")?;
        let flat = |of: MatRef<'_, f64>| of.col_iter().flat_map(|c| c.iter().copied()).collect();
        Self::from_parts(ResidualKdeParts {
            outputs: units.len(),
            neighbours,
            units: units.to_vec(),
            predictions: flat(predictions),
            residuals: flat((targets - predictions).as_ref()),
        })
    }

    /// Assembles a density from its parts, which are validated.
    pub fn from_parts(parts: ResidualKdeParts) -> Result<Self> {
        parts.check()?;
        Ok(Self { parts })
    }

    /// The parts.
    pub fn into_parts(self) -> ResidualKdeParts {
        self.parts
    }

    /// The parts, borrowed.
    pub fn parts(&self) -> &ResidualKdeParts {
        &self.parts
    }

    /// Length m of a target vector.
    pub fn outputs(&self) -> usize {
        self.parts.outputs
    }

    /// At most `count` hypotheses (at least 1) around a `prediction` (length m): the prediction
    /// first, then the others by decreasing weight. Fewer if the residuals nearby form fewer
    /// clusters.
    pub fn hypotheses(&self, prediction: &[f64], count: usize) -> Result<Vec<Hypothesis>> {
        check::length("prediction", self.outputs(), prediction.len())?;
        if let Some(row) = prediction.iter().position(|&v| !check::usable(v)) {
            let value = prediction[row];
            return Err(Error::BadValue { what: "prediction", row, column: 0, value });
        }
        within("count", count, self.parts.neighbours, "from 1 to the number of neighbours")?;
        let residuals = self.residuals_near(prediction);
        let points = PrincipalPoints::of(&residuals, count)?;
        let mut hypotheses: Vec<Hypothesis> = (0..points.count())
            .filter_map(|point| self.hypothesis(prediction, &residuals, &points, point))
            .collect();
        hypotheses[1..].sort_by(|a, b| b.weight.total_cmp(&a.weight));
        Ok(hypotheses)
    }

    /// The residuals, in their units, of the samples whose predictions are nearest to this one,
    /// m×neighbours.
    fn residuals_near(&self, prediction: &[f64]) -> Mat<f64> {
        let ResidualKdeParts { outputs, neighbours, units, predictions, residuals } = &self.parts;
        let distance = |sample: &[f64]| -> f64 {
            let differences = sample.iter().zip(prediction).zip(units);
            differences.map(|((a, b), unit)| ((a - b) / unit).powi(2)).sum()
        };
        let samples = predictions.chunks_exact(*outputs).enumerate();
        let mut order: Vec<(f64, usize)> = samples.map(|(i, p)| (distance(p), i)).collect();
        let nearer = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        order.select_nth_unstable_by(neighbours - 1, nearer);
        Mat::from_fn(*outputs, *neighbours, |j, k| residuals[order[k].1 * outputs + j] / units[j])
    }

    /// One of the points as a hypothesis; nothing if no residual is nearest to it, unless it is the
    /// prediction itself.
    fn hypothesis(
        &self,
        prediction: &[f64],
        residuals: &Mat<f64>,
        points: &PrincipalPoints,
        point: usize,
    ) -> Option<Hypothesis> {
        let members: Vec<usize> =
            (0..residuals.ncols()).filter(|&k| points.nearest[k] == point).collect();
        if members.is_empty() && point > 0 {
            return None;
        }
        let centre = points.centres.col_as_slice(point);
        let units = &self.parts.units;
        let root_mean_square = |values: &mut dyn Iterator<Item = f64>, count: usize| {
            (values.map(|v| v * v).sum::<f64>() / count as f64).sqrt()
        };
        let spread = |j: usize| {
            let mut own = members.iter().map(|&k| residuals[(j, k)] - centre[j]);
            let own = root_mean_square(&mut own, members.len().max(1));
            if members.len() > 1 && own > 0.0 {
                return own;
            }
            let mut all = residuals.row(j).iter().copied();
            known(root_mean_square(&mut all, residuals.ncols()))
        };
        Some(Hypothesis {
            mean: (0..units.len()).map(|j| prediction[j] + units[j] * centre[j]).collect(),
            std: (0..units.len()).map(|j| units[j] * spread(j)).collect(),
            weight: members.len() as f64 / residuals.ncols() as f64,
        })
    }
}

impl TryFrom<ResidualKdeParts> for ResidualKde {
    type Error = Error;

    fn try_from(parts: ResidualKdeParts) -> Result<Self> {
        Self::from_parts(parts)
    }
}

impl From<ResidualKde> for ResidualKdeParts {
    fn from(density: ResidualKde) -> Self {
        density.into_parts()
    }
}

/// Refuses a number that is zero or above the `most`.
fn within(name: &'static str, asked: usize, most: usize, requirement: &'static str) -> Result<()> {
    if (1..=most).contains(&asked) {
        return Ok(());
    }
    Err(Error::Parameter { name, value: asked as f64, requirement })
}
