//! Selection of features by a linear model, then of samples by a Gaussian one.

use faer::MatRef;

use crate::basis::design::Design;
use crate::basis::kernel::{Bandwidth, Kernel};
use crate::basis::normal_equations::Equations;
use crate::basis::spec::BasisSpec;
use crate::data::problem::Problem;
use crate::data::size::ProblemSize;
use crate::error::{Error, Result};
use crate::model::report::{Fit, Report};
use crate::sparse::agarwal_triggs::{AgarwalTriggs, Stop};
use crate::stream::SufficientStatistics;
use crate::stream::summed::Summed;

/// The "both" regressor of de Campos and Murray (2006, section 4): [`AgarwalTriggs`] over linear
/// columns selects features, then [`AgarwalTriggs`] over Gaussian columns on these features selects
/// samples.
///
/// There is one trace for each stage. If no feature survives, the model is the mean.
///
/// ```
/// use phalanx_rvm::{TwoStageSelection, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(30, 200, |i, t| ((t * (3 + i * i)) as f64 * 0.618).fract());
/// let y = Mat::from_fn(1, 200, |_, t| (3.0 * x[(4, t)]).sin() + x[(9, t)]);
/// let model = TwoStageSelection::default().fit(x.as_ref(), y.as_ref())?.model;
/// assert!(model.selected_features().len() < 30 && model.kept_samples().len() < 200);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TwoStageSelection {
    /// When features are dropped.
    pub features: Stop,
    /// When samples are dropped.
    pub samples: Stop,
    /// Bandwidth of the Gaussian kernels on the selected features.
    pub bandwidth: Bandwidth,
    /// ν/m > 0 of both stages, as in [`AgarwalTriggs::nu`].
    pub nu: f64,
}

impl Default for TwoStageSelection {
    fn default() -> Self {
        let stop = AgarwalTriggs::default().stop;
        Self {
            features: stop,
            samples: stop,
            bandwidth: Bandwidth::Relative(1.0),
            nu: AgarwalTriggs::default().nu,
        }
    }
}

impl TwoStageSelection {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        self.bandwidth.check()?;
        let problem = Problem::new(x, y)?;
        let first = self.first(&Design::full(&problem, Kernel::Linear)?)?;
        let features = first.model.selected_features().to_vec();
        self.second(first, &Design::new(&problem, features, Kernel::Gaussian(self.bandwidth))?)
    }

    /// Checks the settings and the size of a problem before there are data. [`fit`](Self::fit) can
    /// still fail because of the values of the data.
    pub fn check(&self, size: ProblemSize) -> Result<()> {
        self.stage(Kernel::Linear, self.features).check(size)?;
        self.stage(Kernel::Gaussian(self.bandwidth), self.samples).check(size)
    }

    /// First of two passes over a stream: the fit over linear columns. The second pass reads its
    /// [`selected_features`](crate::Model::selected_features). If there are none, this is the
    /// result.
    pub fn fit_features(&self, linear: &BasisSpec, sums: &SufficientStatistics) -> Result<Fit> {
        linear.check_kernel(Kernel::Linear)?;
        self.first(&Summed::new(linear, sums)?)
    }

    /// Second pass: the fit over Gaussian columns on the features that the `first` pass selected
    /// ([`BasisSpec::over`]).
    pub fn fit_samples(
        &self,
        first: Fit,
        gaussian: &BasisSpec,
        sums: &SufficientStatistics,
    ) -> Result<Fit> {
        gaussian.check_kernel(Kernel::Gaussian(self.bandwidth))?;
        let selected = first.model.selected_features();
        if let Some(&feature) = gaussian.features().iter().find(|f| !selected.contains(f)) {
            return Err(Error::NotSelected { feature });
        }
        self.second(first, &Summed::new(gaussian, sums)?)
    }

    fn first(&self, linear: &dyn Equations) -> Result<Fit> {
        self.stage(Kernel::Linear, self.features).solve(linear)
    }

    fn second(&self, first: Fit, gaussian: &dyn Equations) -> Result<Fit> {
        if first.model.selected_features().is_empty() {
            return Ok(first);
        }
        let stage = self.stage(Kernel::Gaussian(self.bandwidth), self.samples);
        let Fit { model, report } = stage.solve(gaussian)?;
        let traces = [first.report.traces, report.traces].concat();
        Ok(Fit { model, report: Report::new(traces, report.penalty) })
    }

    fn stage(&self, kernel: Kernel, stop: Stop) -> AgarwalTriggs {
        AgarwalTriggs { kernel, stop, nu: self.nu, ..AgarwalTriggs::default() }
    }
}
