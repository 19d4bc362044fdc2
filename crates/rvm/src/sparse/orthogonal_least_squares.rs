//! Forward selection by orthogonal least squares over all targets.

use faer::{Mat, MatRef};

use crate::basis::design::Design;
use crate::basis::kernel::{Bandwidth, Kernel};
use crate::basis::normal_equations::Equations;
use crate::basis::spec::BasisSpec;
use crate::data::check;
use crate::data::problem::Problem;
use crate::data::size::ProblemSize;
use crate::error::Result;
use crate::linalg;
use crate::model::report::{Fit, Report, Trace};
use crate::ridge::penalised::Penalised;
use crate::stream::SufficientStatistics;
use crate::stream::summed::Summed;

/// A column with less than this share of its energy outside the columns chosen depends on them.
const DEPENDENT: f64 = 1e-10;

/// Orthogonal least squares (Chen, Cowan and Grant 1991) over all targets at once: each step adds
/// the column that most reduces the penalised squared error, summed over targets. It is followed by
/// sequential replacement (Miller 2002): each column in turn is replaced by the best one, until
/// nothing changes.
///
/// The error is ‖Y − AF‖² + λ‖A‖²; a small λ only regularises nearly dependent columns. The trace
/// holds the error after each column and after each sweep of replacements. If all other columns
/// depend on the chosen ones, or the targets are already fitted exactly, fewer than `count` columns
/// are chosen and the report says that the fit did not converge.
///
/// ```
/// use phalanx_rvm::{OrthogonalLeastSquares, Kernel, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(20, 100, |i, t| ((t * (3 + i * i)) as f64 * 0.618).fract());
/// let y = Mat::from_fn(2, 100, |j, t| x[(4, t)] - 2.0 * x[(11 + j, t)]);
/// let selection = OrthogonalLeastSquares { kernel: Kernel::Linear, count: 3, ..Default::default() };
/// let model = selection.fit(x.as_ref(), y.as_ref())?.model;
/// assert_eq!(model.selected_features(), [4, 11, 12]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OrthogonalLeastSquares {
    /// Basis columns.
    pub kernel: Kernel,
    /// Columns to choose, at least 1.
    pub count: usize,
    /// λ > 0.
    pub lambda: f64,
    /// Maximum number of replacement sweeps; 0 for plain forward selection.
    pub sweeps: usize,
}

impl Default for OrthogonalLeastSquares {
    fn default() -> Self {
        let kernel = Kernel::Gaussian(Bandwidth::Relative(1.0));
        Self { kernel, count: 10, lambda: 1e-3, sweeps: 20 }
    }
}

impl OrthogonalLeastSquares {
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

    fn solve(&self, equations: &dyn Equations) -> Result<Fit> {
        self.check_settings(equations.columns().size())?;
        let correlations = equations.correlations();
        let start = Search::new(equations, correlations.as_ref(), self.lambda);
        let mut products = Products::new(equations);
        let (mut kept, mut objective) = self.grow(start.clone(), &mut products);
        self.replace(&start, &mut kept, &mut products, &mut objective);
        kept.sort_unstable();
        let gram = products.between(&kept);
        let correlations = linalg::subrows(correlations.as_ref(), &kept);
        let solved = Penalised::ridge(gram.as_ref(), correlations.as_ref(), self.lambda)?;
        let trace = Trace { converged: kept.len() == self.count, objective };
        let model = solved.model(equations, &kept);
        Ok(Fit { model, report: Report::new(vec![trace], None) })
    }

    fn check_settings(&self, available: usize) -> Result<()> {
        check::positive("lambda", self.lambda)?;
        check::count(self.count, available)
    }

    /// Adds one column after another; returns them and the error after each.
    fn grow(&self, mut search: Search, products: &mut Products<'_>) -> (Vec<usize>, Vec<f64>) {
        let enough = DEPENDENT * search.error;
        let mut objective = Vec::with_capacity(self.count);
        while search.chosen.len() < self.count
            && let Some((best, gain)) = search.best()
            && gain > enough
        {
            search.add(best, products);
            objective.push(search.error);
        }
        (search.chosen, objective)
    }

    /// Sweeps over the columns chosen until none is replaced.
    fn replace(
        &self,
        start: &Search,
        chosen: &mut [usize],
        products: &mut Products<'_>,
        objective: &mut Vec<f64>,
    ) {
        for _ in 0..self.sweeps {
            let (mut replaced, mut error) = (false, f64::INFINITY);
            for place in 0..chosen.len() {
                let mut search = start.clone();
                for (other, &column) in chosen.iter().enumerate() {
                    if other != place {
                        search.add(column, products);
                    }
                }
                let Some((best, gain)) = search.best() else { return };
                error = search.error - gain;
                replaced |= best != chosen[place];
                chosen[place] = best;
            }
            if !replaced {
                return;
            }
            objective.push(error);
        }
    }
}

/// Columns of G = FFᵀ without λ, computed on first use: only those of chosen columns are needed.
struct Products<'a> {
    equations: &'a dyn Equations,
    known: Vec<Option<Vec<f64>>>,
}

impl<'a> Products<'a> {
    fn new(equations: &'a dyn Equations) -> Self {
        Self { equations, known: vec![None; equations.columns().size()] }
    }

    fn with(&mut self, column: usize) -> &[f64] {
        self.known[column].get_or_insert_with(|| self.equations.gram_column(column))
    }

    /// The square submatrix on `kept`.
    fn between(&mut self, kept: &[usize]) -> Mat<f64> {
        let mut out = Mat::zeros(kept.len(), kept.len());
        for (j, &column) in kept.iter().enumerate() {
            let products = self.with(column);
            for (i, &row) in kept.iter().enumerate() {
                out[(i, j)] = products[row];
            }
        }
        out
    }
}

/// A Cholesky factorisation of G + λI pivoted by what each column would gain. The diagonal, which
/// is where λ stands, is kept apart.
#[derive(Clone)]
struct Search {
    chosen: Vec<usize>,
    /// ‖Y − AF‖² + λ‖A‖² with the columns chosen.
    error: f64,
    /// Columns of the factor, one per column chosen, p numbers each.
    factor: Vec<Vec<f64>>,
    /// Squared norm of each column, and what of it lies outside the columns chosen; 0 once chosen.
    total: Vec<f64>,
    outside: Vec<f64>,
    /// Correlation of what is left of each column with what is left of the targets, m×p.
    correlations: Mat<f64>,
}

impl Search {
    fn new(equations: &dyn Equations, correlations: MatRef<'_, f64>, lambda: f64) -> Self {
        let total: Vec<f64> = equations.gram_diagonal().iter().map(|g| g + lambda).collect();
        Self {
            chosen: Vec::new(),
            error: equations.energy(),
            factor: Vec::new(),
            outside: total.clone(),
            total,
            correlations: correlations.transpose().to_owned(),
        }
    }

    /// The column that lowers the error the most, and by how much.
    fn best(&self) -> Option<(usize, f64)> {
        (0..self.total.len())
            .filter(|&k| self.outside[k] > DEPENDENT * self.total[k])
            .map(|k| (k, self.gain(k)))
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
    }

    fn gain(&self, column: usize) -> f64 {
        self.correlations.col(column).squared_norm_l2() / self.outside[column]
    }

    /// Chooses a column and takes it out of all the others and of the targets.
    fn add(&mut self, chosen: usize, products: &mut Products<'_>) {
        self.error -= self.gain(chosen);
        let mut column = products.with(chosen).to_vec();
        for earlier in &self.factor {
            linalg::axpy(&mut column, -earlier[chosen], earlier);
        }
        let pivot = self.outside[chosen].sqrt();
        for value in &mut column {
            *value /= pivot;
        }
        let projection: Vec<f64> =
            self.correlations.col_as_slice(chosen).iter().map(|v| v / pivot).collect();
        for (k, &value) in column.iter().enumerate() {
            self.outside[k] -= value * value;
            linalg::axpy(self.correlations.col_as_slice_mut(k), -value, &projection);
        }
        self.outside[chosen] = 0.0;
        self.chosen.push(chosen);
        self.factor.push(column);
    }
}
