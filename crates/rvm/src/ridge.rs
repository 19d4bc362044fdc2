//! Ridge regression.

use faer::MatRef;

use crate::penalised::Penalised;
use crate::problem::{Design, Problem};
use crate::{Fit, Kernel, Report, Result, Trace, check, linalg};

/// Ridge regression: minimises ‖Y − AF‖² + λ‖A‖² on standardised data.
///
/// This is equation 4 of de Campos and Murray (2006), with one correction: the augmented system
/// printed there, F̃ = (F λI), penalises λ²‖A‖²; here the penalty is λ, as their equation's right
/// side has it. Sums run over all samples, so λ weighs against their number.
///
/// The trace holds the objective.
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
        let design = Design::full(&problem, self.kernel)?;
        let p = design.size();
        let scales = vec![self.lambda.sqrt().recip(); p];
        let correlations = design.correlations();
        let solved = Penalised::solve(design.gram().as_ref(), correlations.as_ref(), scales)?;
        let targets = design.targets();
        // At the minimum the objective is ‖Y‖² − tr(WᵀB).
        let objective = linalg::inner(targets, targets)
            - linalg::inner(solved.weights.as_ref(), correlations.as_ref());
        let model = solved.model(&design, &(0..p).collect::<Vec<_>>());
        let trace = Trace { converged: true, objective: vec![objective] };
        Ok(Fit { model, report: Report::new(vec![trace], None) })
    }
}
