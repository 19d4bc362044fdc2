//! The relevance vector machine for several targets that share their columns.

use faer::{Mat, MatRef};

use crate::basis::design::Design;
use crate::basis::kernel::{Bandwidth, Kernel};
use crate::basis::normal_equations;
use crate::basis::normal_equations::Equations;
use crate::basis::spec::BasisSpec;
use crate::data::problem::Problem;
use crate::data::size::ProblemSize;
use crate::error::{Error, Result};
use crate::model::cholesky_factor::CholeskyFactor;
use crate::model::parts::Posterior;
use crate::model::report::{Fit, Progress, Report};
use crate::rvm::marginal_likelihood::ascent::Ascent;
use crate::rvm::marginal_likelihood::targets::Targets;
use crate::stream::SufficientStatistics;
use crate::stream::summed::Summed;

/// The multivariate relevance vector machine (Thayananthan, Navaratnam, Stenger, Torr and Cipolla
/// 2006) in the fast form of Ha and Zhang (2017, arXiv 1704.05041). The targets share each column's
/// precision, so that all keep the same few columns. The prior of the weights is relative to each
/// target's noise, so that they also share the posterior covariance.
///
/// The marginal likelihood is maximised as in
/// [`RelevanceVectorMachine`](crate::RelevanceVectorMachine): each step adds, re-estimates or
/// deletes one column by a rank-one update, or re-estimates the noise of all targets, whichever
/// increases the evidence most. The trace holds the log evidence of all standardised targets that
/// vary. The bias is not penalised.
///
/// ```
/// use phalanx_rvm::{MultiOutputRvm, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(1, 80, |_, t| t as f64 / 20.0);
/// let y = Mat::from_fn(3, 80, |j, t| (x[(0, t)] * (j + 1) as f64).sin());
/// let rvm = MultiOutputRvm { max_columns: Some(12), ..MultiOutputRvm::default() };
/// let model = rvm.fit(x.as_ref(), y.as_ref())?.model;
/// assert!(model.kept_samples().len() <= 12, "shared by the three targets");
/// assert_eq!(model.weights().shape(), (3, model.kept_samples().len()));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MultiOutputRvm {
    /// Basis columns.
    pub kernel: Kernel,
    /// Maximum number of columns, at least 1. `None`: decided by the evidence alone.
    pub max_columns: Option<usize>,
    /// Lower bound of the noise variance, relative to each target's variance, in (0, 1]. Without
    /// it, noise-free data would drive it to zero.
    pub noise_floor: f64,
    /// What a column must add to the log evidence to be kept, in nats; at least 0. Columns that add
    /// almost nothing only cost prediction time.
    pub min_evidence_gain: f64,
    /// Converged when no step gains more than this, in nats; above 0.
    pub tolerance: f64,
    /// Number of restarts, each from the best solution so far without some neighbouring columns.
    pub restarts: usize,
    /// Maximum number of steps, at least 1.
    pub max_iterations: usize,
}

impl Default for MultiOutputRvm {
    fn default() -> Self {
        Self {
            kernel: Kernel::Gaussian(Bandwidth::Relative(1.0)),
            max_columns: None,
            noise_floor: 1e-4,
            min_evidence_gain: 0.02,
            tolerance: 1e-3,
            restarts: 0,
            max_iterations: 100_000,
        }
    }
}

impl MultiOutputRvm {
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

    /// Like [`fit`](Self::fit), with a call of `observe` after each step.
    pub fn fit_observed(
        &self,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
        observe: &dyn Fn(Progress),
    ) -> Result<Fit> {
        let problem = Problem::new(x, y)?;
        let design = Design::full(&problem, self.kernel)?;
        Ok(self.resume(&design, &Vectors::default(), observe)?.0)
    }

    /// Fits sums over columns of the same kernel.
    pub fn fit_sums(&self, columns: &BasisSpec, sums: &SufficientStatistics) -> Result<Fit> {
        columns.check_kernel(self.kernel)?;
        let summed = Summed::new(columns, sums)?;
        Ok(self.resume(&summed, &Vectors::default(), &|_| ())?.0)
    }

    /// Ascends from given vectors; also returns the final ones.
    pub(crate) fn resume(
        &self,
        equations: &dyn Equations,
        vectors: &Vectors,
        observe: &dyn Fn(Progress),
    ) -> Result<(Fit, Vectors)> {
        let ascent = self.ascent()?;
        let (gram, correlations) = (equations.gram(), equations.correlations());
        let energies = equations.energies();
        let varying: Vec<usize> = (0..energies.len()).filter(|&j| energies[j] > 0.0).collect();
        let correlations =
            Mat::from_fn(gram.ncols(), varying.len(), |k, v| correlations[(k, varying[v])]);
        let of_varying: Vec<f64> = varying.iter().map(|&j| energies[j]).collect();
        let mut start = ascent.start(Targets {
            gram: &gram,
            correlations: correlations.as_ref(),
            energies: &of_varying,
            freedom: equations.samples() as f64 - 1.0,
        })?;
        if !vectors.columns.is_empty() {
            start = start.resume(&vectors.columns, &vectors.alpha)?;
        }
        let (evidence, trace) = ascent.run(start, observe)?;
        let mut noise = vec![0.0; energies.len()];
        for (&j, variance) in varying.iter().zip(evidence.noise()) {
            noise[j] = variance.sqrt();
        }
        let (columns, alpha) = evidence.active();
        let (columns, alpha) = (columns.to_vec(), alpha.to_vec());
        let found = Vectors { columns, alpha, evidence: evidence.value() };
        let (active, mu, factor) = evidence.into_posterior()?;
        let mut kept = active.clone();
        kept.sort_unstable();
        let place = |column: usize| kept.partition_point(|&kept| kept < column);
        let mut weights = Mat::zeros(kept.len(), energies.len());
        for (i, &column) in active.iter().enumerate() {
            for (v, &j) in varying.iter().enumerate() {
                weights[(place(column), j)] = mu[(i, v)];
            }
        }
        let factor =
            CholeskyFactor::pack(active.iter().map(|&k| place(k)).collect(), factor.as_ref());
        let posterior = Posterior::Weights(vec![factor]);
        let model = normal_equations::model(equations, &kept, weights.as_ref(), &noise, posterior);
        Ok((Fit { model, report: Report::new(vec![trace], None) }, found))
    }

    fn ascent(&self) -> Result<Ascent> {
        let &Self {
            max_columns,
            noise_floor,
            min_evidence_gain,
            tolerance,
            restarts,
            max_iterations,
            ..
        } = self;
        if max_columns == Some(0) {
            return Err(Error::Parameter {
                name: "max_columns",
                value: 0.0,
                requirement: "at least 1",
            });
        }
        let most = max_columns.unwrap_or(usize::MAX);
        let ascent =
            Ascent { noise_floor, min_evidence_gain, tolerance, max_iterations, restarts, most };
        ascent.check()?;
        Ok(ascent)
    }
}

/// Relevant columns and their precisions relative to the noise.
#[derive(Debug, Clone, Default)]
pub(crate) struct Vectors {
    pub(crate) columns: Vec<usize>,
    pub(crate) alpha: Vec<f64>,
    /// The log evidence that they give, nats.
    pub(crate) evidence: f64,
}
