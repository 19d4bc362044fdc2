//! Agarwal and Triggs' group-sparse regression.

use faer::{Mat, MatRef};

use crate::basis::design::Design;
use crate::basis::kernel::{Bandwidth, Kernel};
use crate::basis::normal_equations::Equations;
use crate::basis::spec::BasisSpec;
use crate::data::check;
use crate::data::problem::Problem;
use crate::data::size::ProblemSize;
use crate::error::{Error, Result};
use crate::linalg;
use crate::model::report::{Fit, Report, Trace};
use crate::ridge::penalised::Penalised;
use crate::stream::SufficientStatistics;
use crate::stream::summed::Summed;

/// Largest share of the columns that a step towards a count removes.
const PRUNED_AT_ONCE: f64 = 0.15;
/// Times that ν may be halved so that a count of columns survives.
const HALVINGS: i32 = 40;

/// When columns are dropped.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Stop {
    /// The paper's T_a: a column whose norm is at most this is set to zero. At least 0; its scale
    /// depends on the kernel.
    Threshold(f64),
    /// Keep this many columns, at least 1. The weakest columns are dropped, at most 15 % per step,
    /// until this many are left. If ν is too large for all of them to survive, the iteration
    /// restarts from all columns with half of it.
    Count(usize),
}

/// Agarwal and Triggs' group-sparse regression (2004, 2006; de Campos and Murray 2006, section 4):
/// whole columns of A become zero, so that all targets share the remaining columns.
///
/// Starting from ridge regression, the penalty ν log‖a‖² of each column a is replaced by the
/// quadratic "bridge" that touches it at the last solution, ν‖a‖²/‖a_last‖² plus a constant, and
/// the least squares problem is solved again, until A converges. Each step lowers the objective ‖AF
/// − Y‖² + ν Σ log‖a‖² over the remaining columns. The trace holds it; it jumps where columns are
/// dropped. The weights are the fixed point of the iteration, without a refit.
///
/// Here ν is m (the number of targets) times [`nu`](Self::nu). The squared error grows with m, so a
/// good value of `nu` does not depend on m.
///
/// Two corrections to the printed text of 2006: R with ν/a_scale appended to F would penalise
/// ν²/a², where the text (and this crate) has ν‖a‖²/a_scale²; and that bridge has the gradient of
/// 2ν log‖a‖, not of ν log‖a‖.
///
/// ```
/// use phalanx_rvm::{AgarwalTriggs, Kernel, Stop, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(20, 100, |i, t| ((t * (3 + i * i)) as f64 * 0.618).fract());
/// let y = Mat::from_fn(2, 100, |j, t| x[(4, t)] - 2.0 * x[(11 + j, t)]);
/// let bridges = AgarwalTriggs { kernel: Kernel::Linear, stop: Stop::Count(3), ..AgarwalTriggs::default() };
/// let model = bridges.fit(x.as_ref(), y.as_ref())?.model;
/// assert_eq!(model.selected_features(), [4, 11, 12], "shared by both targets");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AgarwalTriggs {
    /// Basis columns.
    pub kernel: Kernel,
    /// ν/m > 0, the strength of the prior for each target. The larger it is, the fewer columns
    /// survive.
    pub nu: f64,
    /// When columns are dropped.
    pub stop: Stop,
    /// λ > 0 of the ridge regression to start from.
    pub lambda: f64,
    /// Converged when A changes by less than this, relative to its norm; above 0.
    pub tolerance: f64,
    /// Most steps, at least 1.
    pub max_iterations: usize,
}

impl Default for AgarwalTriggs {
    fn default() -> Self {
        Self {
            kernel: Kernel::Gaussian(Bandwidth::Relative(1.0)),
            nu: 0.3,
            stop: Stop::Threshold(1e-3),
            lambda: 0.1,
            tolerance: 1e-6,
            max_iterations: 1000,
        }
    }
}

impl AgarwalTriggs {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        let problem = Problem::new(x, y)?;
        self.solve(&Design::full(&problem, self.kernel)?)
    }

    /// Checks the settings and the size of a problem before there are data. [`fit`](Self::fit) can
    /// still fail because of the values of the data.
    pub fn check(&self, size: ProblemSize) -> Result<()> {
        self.kernel.check()?;
        self.check_settings(self.kernel.columns(size)?)
    }

    /// Fits sums over columns of the same kernel.
    pub fn fit_sums(&self, columns: &BasisSpec, sums: &SufficientStatistics) -> Result<Fit> {
        columns.check_kernel(self.kernel)?;
        self.solve(&Summed::new(columns, sums)?)
    }

    pub(crate) fn solve(&self, equations: &dyn Equations) -> Result<Fit> {
        let selected = self.select(equations)?;
        let model = selected.solved.model(equations, &selected.kept);
        Ok(Fit { model, report: Report::new(vec![selected.trace], Some(selected.nu)) })
    }

    /// Runs the bridges over all columns. Halving ν only after the descent would keep
    /// columns that too strong a prior chose.
    fn select(&self, equations: &dyn Equations) -> Result<Selection> {
        self.check_settings(equations.columns().size())?;
        let start = Bridge::start(equations, self.lambda)?;
        let mut nu = self.nu;
        let mut selection = self.descend(start.clone(), nu)?;
        let is_count = matches!(self.stop, Stop::Count(_));
        for _ in 0..HALVINGS {
            if selection.trace.converged || !is_count {
                break;
            }
            nu /= 2.0;
            match self.descend(start.clone(), nu) {
                // So small a prior leaves the last columns to rounding: what the larger one
                // kept is as good as it gets.
                Err(Error::Singular { .. }) => break,
                next => selection = next?,
            }
        }
        Ok(selection)
    }

    /// From all columns down to those kept, at one ν/m.
    fn descend(&self, mut bridge: Bridge, nu: f64) -> Result<Selection> {
        bridge.nu = nu * bridge.weights.ncols() as f64;
        let mut trace = Trace { converged: false, objective: Vec::new() };
        while trace.objective.len() < self.max_iterations && !bridge.kept.is_empty() {
            let change = bridge.step()?;
            trace.objective.push(bridge.objective());
            let pruned = bridge.prune(self.stop);
            if !pruned && change <= self.tolerance {
                trace.converged = matches!(self.stop, Stop::Threshold(_)) || bridge.all_survive();
                break;
            }
        }
        trace.converged |= bridge.kept.is_empty();
        let solved = bridge.solve()?;
        Ok(Selection { kept: bridge.kept, nu, solved, trace })
    }

    fn check_settings(&self, available: usize) -> Result<()> {
        check::positive("nu", self.nu)?;
        check::positive("lambda", self.lambda)?;
        check::positive("tolerance", self.tolerance)?;
        check::iterations(self.max_iterations)?;
        match self.stop {
            Stop::Threshold(t) if t >= 0.0 && t.is_finite() => Ok(()),
            Stop::Threshold(value) => Err(Error::Parameter {
                name: "threshold",
                value,
                requirement: "at least 0 and finite",
            }),
            Stop::Count(asked) => check::count(asked, available),
        }
    }
}

/// The columns that the bridges kept, and their weights.
struct Selection {
    kept: Vec<usize>,
    solved: Penalised,
    /// ν/m as it ended.
    nu: f64,
    trace: Trace,
}

/// The iteration's state, over the columns kept so far.
#[derive(Clone)]
struct Bridge {
    kept: Vec<usize>,
    gram: Mat<f64>,
    correlations: Mat<f64>,
    /// Kept×m.
    weights: Mat<f64>,
    /// ‖Y‖².
    energy: f64,
    nu: f64,
}

impl Bridge {
    /// All columns, with the weights of ridge regression; ν is still to be set.
    fn start(equations: &dyn Equations, lambda: f64) -> Result<Self> {
        let (gram, correlations) = (equations.gram(), equations.correlations());
        Ok(Self {
            kept: (0..gram.ncols()).collect(),
            weights: Penalised::ridge(gram.as_ref(), correlations.as_ref(), lambda)?.weights,
            gram,
            correlations,
            energy: equations.energy(),
            nu: 0.0,
        })
    }

    /// Least squares with each column's bridge at its present norm.
    fn solve(&self) -> Result<Penalised> {
        let norms = linalg::row_norms(self.weights.as_ref());
        let scales = norms.iter().map(|norm| norm / self.nu.sqrt()).collect();
        Penalised::solve(self.gram.as_ref(), self.correlations.as_ref(), scales)
    }

    /// One step; returns how much the weights changed, relative to their norm.
    fn step(&mut self) -> Result<f64> {
        let weights = self.solve()?.weights;
        let change = (&weights - &self.weights).norm_l2();
        self.weights = weights;
        Ok(change / self.weights.norm_l2().max(f64::MIN_POSITIVE))
    }

    /// ‖AF − Y‖² + ν Σ log‖a‖² over the columns that are not zero.
    fn objective(&self) -> f64 {
        let fitted = linalg::product(self.gram.as_ref(), self.weights.as_ref());
        let weights = self.weights.as_ref();
        let error = self.energy - 2.0 * linalg::inner(weights, self.correlations.as_ref())
            + linalg::inner(weights, fitted.as_ref());
        let norms = linalg::row_norms(weights);
        let logs: f64 = norms.iter().filter(|&&norm| norm > 0.0).map(|norm| 2.0 * norm.ln()).sum();
        error + self.nu * logs
    }

    /// Drops columns; returns whether there were any to drop.
    fn prune(&mut self, stop: Stop) -> bool {
        let norms = linalg::row_norms(self.weights.as_ref());
        let mut order: Vec<usize> = (0..norms.len()).collect();
        match stop {
            Stop::Threshold(threshold) => order.retain(|&k| norms[k] > threshold),
            Stop::Count(count) => {
                let most = (PRUNED_AT_ONCE * norms.len() as f64).ceil() as usize;
                order.sort_by(|&a, &b| norms[b].total_cmp(&norms[a]));
                order.truncate(count.max(norms.len() - most));
                order.sort_unstable();
            }
        }
        let dropped = order.len() < norms.len();
        if dropped {
            self.kept = order.iter().map(|&k| self.kept[k]).collect();
            self.gram = linalg::submatrix(self.gram.as_ref(), &order);
            self.correlations = linalg::subrows(self.correlations.as_ref(), &order);
            self.weights = linalg::subrows(self.weights.as_ref(), &order);
        }
        dropped
    }

    /// A column rests only where G_kk‖a‖² ≥ ν: below, it is on its way to zero.
    fn all_survive(&self) -> bool {
        let norms = linalg::row_norms(self.weights.as_ref());
        norms.iter().enumerate().all(|(k, norm)| self.gram[(k, k)] * norm * norm > 0.5 * self.nu)
    }
}
