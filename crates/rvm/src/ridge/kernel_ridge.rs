//! Dense kernel ridge regression with a leave-one-out choice of its penalty.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::basis::design::Design;
use crate::basis::kernel::{Bandwidth, Kernel};
use crate::basis::normal_equations;
use crate::data::check;
use crate::data::problem::Problem;
use crate::data::size::ProblemSize;
use crate::error::{Error, Result};
use crate::linalg;
use crate::model::cholesky_factor::CholeskyFactor;
use crate::model::parts::Posterior;
use crate::model::report::{Fit, Report, Trace};
use crate::ridge::penalised::Penalised;

/// How λ of [`KernelRidge`] is chosen.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Regularisation {
    /// A fixed λ > 0.
    Fixed(f64),
    /// The λ of this grid (all > 0) with the smallest squared leave-one-out error over all
    /// standardised targets.
    Loocv(Vec<f64>),
}

/// Dense kernel ridge regression with a Gaussian kernel on every sample and an unpenalised bias;
/// the mean of a Gaussian process (Rasmussen and Williams 2006, sections 2.2 and 5.4.2).
///
/// The standard deviation is that of the process and grows to the prior's far from the samples. The
/// noise is scaled so that the leave-one-out errors have unit variance. The trace holds the mean
/// squared leave-one-out error of each λ of the grid, in standardised units (infinite where the
/// system is singular). The report's penalty is the chosen λ.
///
/// Time and memory grow with the cube and the square of the number of samples.
///
/// ```
/// use phalanx_rvm::{KernelRidge, Regularisation, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(1, 50, |_, t| t as f64 / 8.0);
/// let y = Mat::from_fn(1, 50, |_, t| x[(0, t)].cos());
/// let regularisation = Regularisation::Loocv(vec![1e-6, 1e-3, 1.0]);
/// let ridge = KernelRidge { regularisation, ..KernelRidge::default() };
/// let fit = ridge.fit(x.as_ref(), y.as_ref())?;
/// assert_eq!(fit.report.penalty, Some(1e-6), "there is no noise to smooth away");
/// assert_eq!(fit.model.kept_samples().len(), 50);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct KernelRidge {
    /// Bandwidth of the kernel.
    pub bandwidth: Bandwidth,
    /// How λ is chosen.
    pub regularisation: Regularisation,
}

impl Default for KernelRidge {
    fn default() -> Self {
        let grid = (-5..=1).map(|e| 10_f64.powi(e)).collect();
        Self { bandwidth: Bandwidth::Relative(3.0), regularisation: Regularisation::Loocv(grid) }
    }
}

impl KernelRidge {
    /// Fits X (K×I) to Y (m×I).
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        let grid = self.grid()?;
        let problem = Problem::new(x, y)?;
        let design = Design::full(&problem, Kernel::Gaussian(self.bandwidth))?;
        let n = design.size();
        if n < 2 {
            return mean(&design, grid[0]);
        }
        let centred = doubly_centred(&design);
        let errors: Vec<f64> = grid
            .par_iter()
            .map(|&lambda| {
                Dual::solve(&centred, design.targets(), lambda)
                    .map_or(f64::INFINITY, |dual| dual.mean_squared_error())
            })
            .collect();
        let best = (0..grid.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b]));
        let lambda = grid[best.unwrap_or(0)];
        let dual =
            Dual::solve(&centred, design.targets(), lambda).ok_or(Error::Singular { size: n })?;
        let kept: Vec<usize> = (0..n).collect();
        let factor = CholeskyFactor::pack(kept.clone(), dual.factor.as_ref());
        let posterior = Posterior::Process { factor, lambda };
        let weights = dual.weights.as_ref();
        let model = normal_equations::model(&design, &kept, weights, &dual.noise(), posterior);
        let trace = Trace { converged: true, objective: errors };
        Ok(Fit { model, report: Report::new(vec![trace], Some(lambda)) })
    }

    /// Checks the settings and the size of a problem before there are data. [`fit`](Self::fit) can
    /// still fail because of the values of the data.
    pub fn check(&self, size: ProblemSize) -> Result<()> {
        self.grid()?;
        self.bandwidth.check()?;
        Kernel::Gaussian(self.bandwidth).columns(size).map(drop)
    }

    fn grid(&self) -> Result<&[f64]> {
        let grid = match &self.regularisation {
            Regularisation::Fixed(lambda) => std::slice::from_ref(lambda),
            Regularisation::Loocv(grid) => grid,
        };
        check::grid(grid)?;
        Ok(grid)
    }
}

/// The fit where nothing varies: the mean.
fn mean(design: &Design<'_>, lambda: f64) -> Result<Fit> {
    let none = Penalised::solve(
        Mat::zeros(0, 0).as_ref(),
        Mat::zeros(0, design.targets().ncols()).as_ref(),
        Vec::new(),
    )?;
    let trace = Trace { converged: true, objective: Vec::new() };
    Ok(Fit { model: none.model(design, &[]), report: Report::new(vec![trace], Some(lambda)) })
}

/// K̃ = H K H: the columns come centred, now the rows too.
fn doubly_centred(design: &Design<'_>) -> Mat<f64> {
    let mut k = design.phi.clone();
    let n = k.ncols();
    let mut means = vec![0.0; n];
    for j in 0..n {
        linalg::axpy(&mut means, 1.0 / n as f64, k.col_as_slice(j));
    }
    for j in 0..n {
        linalg::axpy(k.col_as_slice_mut(j), -1.0, &means);
    }
    k
}

/// The dual solution for one λ.
struct Dual {
    /// M with MᵀM = (K̃ + λI)⁻¹.
    factor: Mat<f64>,
    /// (K̃ + λI)⁻¹Y, I×m.
    weights: Mat<f64>,
    /// Noise variance of each sample's leave-one-out prediction is the noise over this:
    /// 1 − hᵢᵢ = λ[(K̃ + λI)⁻¹]ᵢᵢ − 1/I, with the bias left out too.
    leverage: Vec<f64>,
    lambda: f64,
}

impl Dual {
    fn solve(centred: &Mat<f64>, targets: MatRef<'_, f64>, lambda: f64) -> Option<Self> {
        let mut system = centred.clone();
        let n = system.ncols();
        for i in 0..n {
            system[(i, i)] += lambda;
        }
        let factor = linalg::lower_inverse(linalg::cholesky(system)?.as_ref());
        let half = linalg::product(factor.as_ref(), targets);
        let weights = linalg::product(factor.transpose(), half.as_ref());
        let leverage: Vec<f64> =
            (0..n).map(|i| lambda * factor.col(i).squared_norm_l2() - 1.0 / n as f64).collect();
        leverage.iter().all(|&l| l > 0.0).then_some(Self { factor, weights, leverage, lambda })
    }

    /// Residual of sample i and target j when the sample is left out of the fit.
    fn left_out(&self, i: usize, j: usize) -> f64 {
        self.lambda * self.weights[(i, j)] / self.leverage[i]
    }

    fn mean_squared_error(&self) -> f64 {
        let (n, m) = self.weights.shape();
        let total: f64 =
            (0..m).map(|j| (0..n).map(|i| self.left_out(i, j).powi(2)).sum::<f64>()).sum();
        total / (n * m) as f64
    }

    /// Noise deviation of each target that gives the leave-one-out errors unit variance.
    fn noise(&self) -> Vec<f64> {
        let (n, m) = self.weights.shape();
        let variance = |j| {
            (0..n).map(|i| self.left_out(i, j).powi(2) * self.leverage[i]).sum::<f64>() / n as f64
        };
        (0..m).map(|j| variance(j).sqrt()).collect()
    }
}
