//! Ridge regression.

pub(crate) mod kernel_ridge;
pub(crate) mod nystrom;
pub(crate) mod penalised;

use faer::MatRef;

use crate::basis::design::Design;
use crate::basis::kernel::Kernel;
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

/// Ridge regression: minimises ‖Y − AF‖² + λ‖A‖² on standardised data.
///
/// This is equation 4 of de Campos and Murray (2006), with one correction: the augmented system
/// printed there, F̃ = (F λI), penalises λ²‖A‖²; here the penalty is λ‖A‖², as on the right side of
/// their equation. Errors are summed over samples, not averaged, so the effect of λ decreases with
/// their number.
///
/// The trace holds the objective.
///
/// ```
/// use phalanx_rvm::{Kernel, Ridge, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(2, 30, |i, t| (t * (i + 1)) as f64 % 7.0);
/// let y = Mat::from_fn(1, 30, |_, t| 3.0 * x[(0, t)] - x[(1, t)] + 5.0);
/// let ridge = Ridge { kernel: Kernel::Linear, lambda: 1e-6 };
/// let model = ridge.fit(x.as_ref(), y.as_ref())?.model;
/// let predicted = model.predict(x.as_ref())?;
/// assert!((predicted[(0, 3)] - y[(0, 3)]).abs() < 1e-4);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Ridge {
    /// Basis columns.
    pub kernel: Kernel,
    /// λ > 0.
    pub lambda: f64,
}

impl Default for Ridge {
    fn default() -> Self {
        Self { kernel: Kernel::Linear, lambda: 1.0 }
    }
}

impl Ridge {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        check::positive("lambda", self.lambda)?;
        let problem = Problem::new(x, y)?;
        self.solve(&Design::full(&problem, self.kernel)?)
    }

    /// Checks the settings and the size of a problem before there are data. [`fit`](Self::fit) can
    /// still fail because of the values of the data.
    pub fn check(&self, size: ProblemSize) -> Result<()> {
        check::positive("lambda", self.lambda)?;
        self.kernel.check()?;
        self.kernel.columns(size).map(drop)
    }

    /// Fits sums over columns of the same kernel.
    pub fn fit_sums(&self, columns: &BasisSpec, sums: &SufficientStatistics) -> Result<Fit> {
        columns.check_kernel(self.kernel)?;
        self.solve(&Summed::new(columns, sums)?)
    }

    fn solve(&self, equations: &dyn Equations) -> Result<Fit> {
        check::positive("lambda", self.lambda)?;
        let (gram, correlations) = (equations.gram(), equations.correlations());
        let solved = Penalised::ridge(gram.as_ref(), correlations.as_ref(), self.lambda)?;
        // At the minimum the objective is ‖Y‖² − tr(WᵀB).
        let objective =
            equations.energy() - linalg::inner(solved.weights.as_ref(), correlations.as_ref());
        let model = solved.model(equations, &(0..gram.ncols()).collect::<Vec<_>>());
        let trace = Trace { converged: true, objective: vec![objective] };
        Ok(Fit { model, report: Report::new(vec![trace], None) })
    }
}
