//! Forward selection by orthogonal least squares over all targets.

use faer::{Mat, MatRef};

use crate::penalised::Penalised;
use crate::problem::{Design, Problem};
use crate::{Fit, Kernel, Report, Result, Trace, Width, check, linalg};

/// A column with less than this share of its energy outside the columns chosen depends on them.
const DEPENDENT: f64 = 1e-10;

/// Orthogonal least squares (Chen, Cowan and Grant 1991), over all targets at once: each step adds
/// the column that lowers the penalised squared error of all targets together the most.
///
/// The error is ‖Y − AF‖² + λ‖A‖²; a small λ only keeps nearly dependent columns apart. The trace
/// holds the error after each column. Fewer than `count` columns are chosen, and the fit said not
/// to have converged, if the others depend on those chosen or the targets are already met.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ForwardSelection {
    /// Basis columns.
    pub kernel: Kernel,
    /// Columns to choose, at least 1.
    pub count: usize,
    /// λ > 0.
    pub lambda: f64,
}

impl Default for ForwardSelection {
    fn default() -> Self {
        Self { kernel: Kernel::Gaussian(Width::Scatter(1.0)), count: 10, lambda: 1e-3 }
    }
}

impl ForwardSelection {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        check::positive("lambda", self.lambda)?;
        let problem = Problem::new(x, y)?;
        let design = Design::full(&problem, self.kernel)?;
        check::count(self.count, design.size())?;
        let mut search = Search::new(&design, self.lambda);
        let mut error = linalg::inner(design.targets(), design.targets());
        let enough = DEPENDENT * error;
        let mut objective = Vec::with_capacity(self.count);
        while search.chosen.len() < self.count
            && let Some((best, gain)) = search.best()
            && gain > enough
        {
            search.add(best);
            error -= gain;
            objective.push(error);
        }
        let mut kept = search.chosen;
        kept.sort_unstable();
        let columns =
            Mat::from_fn(design.columns.nrows(), kept.len(), |i, k| design.columns[(i, kept[k])]);
        let gram = linalg::gram(columns.as_ref());
        let correlations = linalg::product(columns.transpose(), design.targets());
        let scales = vec![self.lambda.sqrt().recip(); kept.len()];
        let solved = Penalised::solve(gram.as_ref(), correlations.as_ref(), scales)?;
        let trace = Trace { converged: kept.len() == self.count, objective };
        let model = solved.model(&design, &kept);
        Ok(Fit { model, report: Report::new(vec![trace], None) })
    }
}

/// A Cholesky factorisation of G + λI pivoted by what each column would gain. Only the columns
/// of G that are chosen are ever computed, and of those only what the columns left over need: no
/// diagonal, which is where λ stands.
struct Search<'a> {
    columns: MatRef<'a, f64>,
    chosen: Vec<usize>,
    /// Columns of the factor, one per column chosen, p numbers each.
    factor: Vec<Vec<f64>>,
    /// Squared norm of each column, and what of it lies outside the columns chosen; 0 once chosen.
    total: Vec<f64>,
    outside: Vec<f64>,
    /// Correlation of what is left of each column with what is left of the targets, m×p.
    correlations: Mat<f64>,
}

impl<'a> Search<'a> {
    fn new(design: &'a Design<'_>, lambda: f64) -> Self {
        let columns = design.columns.as_ref();
        let total: Vec<f64> = columns.col_iter().map(|c| c.squared_norm_l2() + lambda).collect();
        Self {
            columns,
            chosen: Vec::new(),
            factor: Vec::new(),
            outside: total.clone(),
            total,
            correlations: linalg::product(design.targets().transpose(), columns),
        }
    }

    /// The column that lowers the error the most, and by how much.
    fn best(&self) -> Option<(usize, f64)> {
        let gain = |k: usize| self.correlations.col(k).squared_norm_l2() / self.outside[k];
        (0..self.total.len())
            .filter(|&k| self.outside[k] > DEPENDENT * self.total[k])
            .map(|k| (k, gain(k)))
            .max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))
    }

    /// Chooses column `best` and takes it out of all the others and of the targets.
    fn add(&mut self, best: usize) {
        let chosen = self.columns.subcols(best, 1);
        let mut column = linalg::product(self.columns.transpose(), chosen).col_as_slice(0).to_vec();
        for earlier in &self.factor {
            linalg::axpy(&mut column, -earlier[best], earlier);
        }
        let pivot = self.outside[best].sqrt();
        for value in &mut column {
            *value /= pivot;
        }
        let projection: Vec<f64> =
            self.correlations.col_as_slice(best).iter().map(|v| v / pivot).collect();
        for (k, &value) in column.iter().enumerate() {
            self.outside[k] -= value * value;
            linalg::axpy(self.correlations.col_as_slice_mut(k), -value, &projection);
        }
        self.outside[best] = 0.0;
        self.chosen.push(best);
        self.factor.push(column);
    }
}
