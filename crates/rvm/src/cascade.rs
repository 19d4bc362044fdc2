//! Features selected linearly, then samples by Gaussian kernels.

use faer::MatRef;

use crate::bridges::{Bridges, Stop};
use crate::problem::{Design, Problem};
use crate::{Fit, Kernel, Report, Result, Width};

/// The paper's "both" (de Campos and Murray 2006, section 4): bridges over linear columns select
/// features, then bridges over Gaussian columns on those features select samples.
///
/// The traces are the two stages'. If no feature survives, the model is the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cascade {
    /// When features are dropped.
    pub features: Stop,
    /// When samples are dropped.
    pub samples: Stop,
    /// Width of the Gaussian kernels, on the features selected.
    pub width: Width,
    /// ν/m > 0 of both stages, as in [`Bridges::nu`].
    pub nu: f64,
}

impl Default for Cascade {
    fn default() -> Self {
        let stop = Bridges::default().stop;
        Self {
            features: stop,
            samples: stop,
            width: Width::Scatter(1.0),
            nu: Bridges::default().nu,
        }
    }
}

impl Cascade {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        let bridges = |kernel, stop| Bridges { kernel, stop, nu: self.nu, ..Bridges::default() };
        let gaussian = Kernel::Gaussian(self.width);
        gaussian.check()?;
        let problem = Problem::new(x, y)?;
        let linear = Design::full(&problem, Kernel::Linear)?;
        let first = bridges(Kernel::Linear, self.features).select(&linear)?;
        let features: Vec<usize> = first.kept.iter().map(|&k| linear.features()[k]).collect();
        if features.is_empty() {
            let model = first.solved.model(&linear, &first.kept);
            return Ok(Fit { model, report: Report::new(vec![first.trace], Some(first.nu)) });
        }
        let design = Design::new(&problem, features, gaussian)?;
        let second = bridges(gaussian, self.samples).select(&design)?;
        let model = second.solved.model(&design, &second.kept);
        let traces = vec![first.trace, second.trace];
        Ok(Fit { model, report: Report::new(traces, Some(second.nu)) })
    }
}
