//! The relevance vector machine, for each target by itself.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::basis::design::Design;
use crate::basis::kernel::{Bandwidth, Kernel};
use crate::basis::normal_equations;
use crate::basis::normal_equations::Equations;
use crate::data::problem::Problem;
use crate::data::size::ProblemSize;
use crate::error::Result;
use crate::model::Model;
use crate::model::cholesky_factor::CholeskyFactor;
use crate::model::parts::Posterior;
use crate::model::report::{Fit, Progress, Report, Trace};
use crate::rvm::marginal_likelihood::MarginalLikelihood;
use crate::rvm::marginal_likelihood::ascent::Ascent;
use crate::rvm::marginal_likelihood::targets::Targets;

/// The relevance vector machine (Tipping 2001), fitted by fast marginal likelihood maximisation
/// (Tipping and Faul 2003), for each target by itself.
///
/// Each step adds, re-estimates or deletes one column by a rank-one update, or re-estimates the
/// noise, whichever increases the evidence most. It converges to a local optimum that depends on
/// the first steps; [`restarts`](Self::restarts) searches for better ones. The bias is not
/// penalised. The traces, one per target, hold the log evidence of the standardised target in nats,
/// after each step of the first ascent and after each restart that found a better optimum. It
/// decreases only where a column is dropped that gains less than
/// [`min_evidence_gain`](Self::min_evidence_gain).
///
/// ```
/// use phalanx_rvm::{RelevanceVectorMachine, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(1, 100, |_, t| t as f64 / 10.0);
/// let y = Mat::from_fn(1, 100, |_, t| x[(0, t)].sin());
/// let fit = RelevanceVectorMachine::default().fit(x.as_ref(), y.as_ref())?;
/// assert!(fit.report.traces[0].converged);
/// assert!(fit.model.kept_samples().len() < 20, "of 100");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RelevanceVectorMachine {
    /// Basis columns.
    pub kernel: Kernel,
    /// Lower bound of the noise variance, relative to the target's variance, in (0, 1]. Without it,
    /// noise-free data would drive it to zero.
    pub noise_floor: f64,
    /// What a column must add to the log evidence to be kept, in nats; at least 0. Columns that add
    /// almost nothing only cost prediction time.
    pub min_evidence_gain: f64,
    /// Converged when no step gains more than this, in nats; above 0.
    pub tolerance: f64,
    /// Number of restarts, each from the best solution so far without some neighbouring columns.
    pub restarts: usize,
    /// Maximum number of steps per target, at least 1.
    pub max_iterations: usize,
}

impl Default for RelevanceVectorMachine {
    fn default() -> Self {
        Self {
            kernel: Kernel::Gaussian(Bandwidth::Relative(3.0)),
            noise_floor: 1e-4,
            min_evidence_gain: 0.02,
            tolerance: 1e-3,
            restarts: 15,
            max_iterations: 100_000,
        }
    }
}

impl RelevanceVectorMachine {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        self.fit_observed(x, y, &|_| ())
    }

    /// Checks the settings and the size of a problem before there are data. [`fit`](Self::fit) can
    /// still fail because of the values of the data.
    pub fn check(&self, size: ProblemSize) -> Result<()> {
        self.ascent()?;
        self.kernel.check()?;
        self.kernel.columns(size).map(drop)
    }

    /// Like [`fit`](Self::fit), with a call of `observe` after each step. Targets are fitted in
    /// parallel, so several threads may call it at once.
    ///
    /// ```
    /// use std::sync::atomic::{AtomicUsize, Ordering};
    /// use phalanx_rvm::{RelevanceVectorMachine, faer::Mat};
    ///
    /// # fn main() -> phalanx_rvm::Result<()> {
    /// let x = Mat::from_fn(1, 50, |_, t| t as f64 / 5.0);
    /// let y = Mat::from_fn(1, 50, |_, t| x[(0, t)].sin());
    /// let most = AtomicUsize::new(0);
    /// RelevanceVectorMachine::default().fit_observed(x.as_ref(), y.as_ref(), &|progress| {
    ///     most.fetch_max(progress.vectors, Ordering::Relaxed);
    /// })?;
    /// assert!(most.into_inner() > 0);
    /// # Ok(())
    /// # }
    /// ```
    pub fn fit_observed(
        &self,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
        observe: &(dyn Fn(Progress) + Sync),
    ) -> Result<Fit> {
        let ascent = self.ascent()?;
        let problem = Problem::new(x, y)?;
        let design = Design::full(&problem, self.kernel)?;
        let (gram, correlations) = (design.gram(), design.correlations());
        let energies = design.energies();
        let rows: Vec<(Row, Trace)> = (0..energies.len())
            .into_par_iter()
            .map(|j| {
                if energies[j] == 0.0 {
                    let trace = Trace { converged: true, objective: Vec::new() };
                    return Ok((Row::constant(), trace));
                }
                let start = ascent.start(Targets {
                    gram: &gram,
                    correlations: correlations.as_ref().subcols(j, 1),
                    energies: &energies[j..=j],
                    freedom: design.samples() as f64 - 1.0,
                })?;
                let (evidence, trace) =
                    ascent.run(start, &|progress| observe(Progress { target: j, ..progress }))?;
                Ok((Row::new(evidence)?, trace))
            })
            .collect::<Result<_>>()?;
        let (rows, traces): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        Ok(Fit { model: join(&design, rows), report: Report::new(traces, None) })
    }

    fn ascent(&self) -> Result<Ascent> {
        let &Self { noise_floor, tolerance, min_evidence_gain, restarts, max_iterations, .. } =
            self;
        let most = usize::MAX;
        let ascent =
            Ascent { noise_floor, min_evidence_gain, tolerance, max_iterations, restarts, most };
        ascent.check()?;
        Ok(ascent)
    }
}

/// One target's relevant columns.
struct Row {
    weights: Vec<f64>,
    /// Noise deviation.
    noise: f64,
    /// M with Σ = σ² MᵀM, over columns of the design.
    factor: CholeskyFactor,
}

impl Row {
    /// A target that does not vary.
    fn constant() -> Self {
        let factor = CholeskyFactor { columns: Vec::new(), packed: Vec::new() };
        Self { weights: Vec::new(), noise: 0.0, factor }
    }

    fn new(evidence: MarginalLikelihood<'_>) -> Result<Self> {
        let noise = evidence.noise()[0].sqrt();
        let (active, weights, factor) = evidence.into_posterior()?;
        let weights = weights.col_as_slice(0).to_vec();
        Ok(Self { weights, noise, factor: CholeskyFactor::pack(active, factor.as_ref()) })
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
    normal_equations::model(design, &kept, weights.as_ref(), &noise, Posterior::Weights(factors))
}
