//! Tipping's relevance vector machine, one target at a time.

mod evidence;

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::design::Design;
use crate::equations::{self, Equations};
use crate::model::{Factor, Posterior};
use crate::problem::Problem;
use crate::{Error, Fit, Kernel, Model, Report, Result, Trace, Width, check};
use evidence::{Evidence, Target};

/// First guess of the noise, as a share of the target's variance.
const FIRST_NOISE: f64 = 0.1;
/// The noise has settled when its logarithm moves by less.
const NOISE_SETTLED: f64 = 1e-3;

/// Tipping's relevance vector machine (2001) by fast marginal likelihood maximisation (Tipping and
/// Faul 2003), for each target by itself.
///
/// Each step adds, re-estimates or deletes the one column that raises the evidence the most; when
/// no step gains, or after as many steps as there are columns, the noise variance is re-estimated
/// (MacKay's update, or the EM update where that one would lower the evidence). An unpenalised
/// bias stands beside the columns. The traces, one per target, hold the log evidence in nats after
/// each step, of the standardised target; it never falls.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tipping {
    /// Basis columns.
    pub kernel: Kernel,
    /// Least noise variance, as a share of the target's variance, in (0, 1]: data without noise
    /// would drive it to zero.
    pub noise_floor: f64,
    /// Steps that gain less than this, in nats, are not taken; above 0.
    pub tolerance: f64,
    /// Most steps per target, at least 1.
    pub max_iterations: usize,
}

impl Default for Tipping {
    fn default() -> Self {
        Self {
            kernel: Kernel::Gaussian(Width::Scatter(3.0)),
            noise_floor: 1e-4,
            tolerance: 1e-4,
            max_iterations: 10_000,
        }
    }
}

impl Tipping {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        self.check()?;
        let problem = Problem::new(x, y)?;
        let design = Design::full(&problem, self.kernel)?;
        let (gram, correlations) = (design.gram(), design.correlations());
        let rows: Vec<(Row, Trace)> = (0..design.targets().ncols())
            .into_par_iter()
            .map(|j| {
                let target = Target {
                    gram: gram.as_ref(),
                    correlations: correlations.col_as_slice(j),
                    energy: design.targets().col(j).squared_norm_l2(),
                    freedom: design.targets().nrows() as f64 - 1.0,
                };
                self.maximise(target)
            })
            .collect::<Result<_>>()?;
        let (rows, traces): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        Ok(Fit { model: join(&design, rows), report: Report::new(traces, None) })
    }

    fn check(&self) -> Result<()> {
        check::positive("tolerance", self.tolerance)?;
        check::iterations(self.max_iterations)?;
        if self.noise_floor > 0.0 && self.noise_floor <= 1.0 {
            return Ok(());
        }
        Err(Error::Parameter {
            name: "noise_floor",
            value: self.noise_floor,
            requirement: "above 0 and at most 1",
        })
    }

    /// Maximises the evidence of one target.
    fn maximise(&self, target: Target<'_>) -> Result<(Row, Trace)> {
        let mut trace = Trace { converged: false, objective: Vec::new() };
        if target.energy == 0.0 {
            trace.converged = true;
            return Ok((Row::constant(), trace));
        }
        let mut evidence = Evidence::new(target, FIRST_NOISE.max(self.noise_floor))?;
        while trace.objective.len() < self.max_iterations {
            // A new noise variance costs about as much as a step for each active column.
            let most =
                (10 + evidence.active().len()).min(self.max_iterations - trace.objective.len());
            let mut gains = false;
            for _ in 0..most {
                let step = evidence.best_step();
                gains = step.gain > self.tolerance;
                if !gains {
                    break;
                }
                evidence.take(&step);
                trace.objective.push(evidence.value());
            }
            let moved = evidence.update_noise(self.noise_floor)?;
            if !gains && moved < NOISE_SETTLED {
                trace.converged = true;
                break;
            }
        }
        Ok((Row::new(evidence)?, trace))
    }
}

/// One target's relevant columns.
struct Row {
    weights: Vec<f64>,
    /// Noise deviation.
    noise: f64,
    /// M with Σ = σ² MᵀM, over columns of the design.
    factor: Factor,
}

impl Row {
    /// A target that does not vary.
    fn constant() -> Self {
        let factor = Factor { columns: Vec::new(), packed: Vec::new() };
        Self { weights: Vec::new(), noise: 0.0, factor }
    }

    fn new(evidence: Evidence<'_>) -> Result<Self> {
        let noise = evidence.noise().sqrt();
        let (active, weights, lower) = evidence.into_posterior()?;
        let mut factor = Factor::pack(active, lower.as_ref());
        factor.packed.iter_mut().for_each(|v| *v /= noise);
        Ok(Self { weights, noise, factor })
    }
}

/// Joins the targets' rows into one model over all columns that any of them keeps.
fn join(design: &Design<'_>, rows: Vec<Row>) -> Model {
    let mut kept: Vec<usize> = rows.iter().flat_map(|row| row.factor.columns.clone()).collect();
    kept.sort_unstable();
    kept.dedup();
    let mut weights = Mat::zeros(kept.len(), rows.len());
    let mut factors = Vec::with_capacity(rows.len());
    let mut noise = Vec::with_capacity(rows.len());
    for (j, mut row) in rows.into_iter().enumerate() {
        for (column, weight) in row.factor.columns.iter_mut().zip(row.weights) {
            *column = kept.partition_point(|kept| kept < column);
            weights[(*column, j)] = weight;
        }
        factors.push(row.factor);
        noise.push(row.noise);
    }
    equations::model(design, &kept, weights.as_ref(), &noise, Posterior::Weights(factors))
}
