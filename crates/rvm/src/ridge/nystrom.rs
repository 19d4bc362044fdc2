//! Kernel ridge regression with Gaussians on a subset of the samples (Nyström).

use faer::{Mat, MatRef};
use phalanx_sampling::random_subset;

use crate::basis::kernel::{Bandwidth, Kernel};
use crate::basis::normal_equations;
use crate::basis::normal_equations::Equations;
use crate::basis::spec::BasisSpec;
use crate::data::check;
use crate::data::problem::Problem;
use crate::data::size::ProblemSize;
use crate::error::{Error, Result};
use crate::linalg;
use crate::model::Model;
use crate::model::cholesky_factor::CholeskyFactor;
use crate::model::parts::Posterior;
use crate::model::report::{Fit, Report, Trace};
use crate::ridge::penalised;
use crate::ridge::penalised::Penalised;
use crate::stream::summed::Summed;
use crate::stream::{self, SufficientStatistics};

/// Added to the kernel's diagonal of ones. Where the centres' Gaussians depend on each other,
/// whitening divides the rounding of G by this: a smaller one leaves small λ unsolvable for many
/// centres among few inputs. It moves no target's fitted values by more than its share of λ of the
/// target's own norm; between the samples they may move some times as much.
const JITTER: f64 = 1e-6;
/// Samples that `fit` adds at a time.
const BATCH: usize = 4096;
/// Seed of the choice of centres in `fit`.
const SEED: u64 = 0;

/// How λ of [`NystromRidge`] is chosen.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NystromRegularisation {
    /// A fixed λ > 0.
    Fixed(f64),
    /// The λ of this grid (all > 0) with the smallest generalised cross-validation error (Golub,
    /// Heath and Wahba 1979): the leave-one-out error with every leverage replaced by the mean,
    /// which can be computed from sums.
    Gcv(Vec<f64>),
}

/// What the standard deviation of a [`NystromRidge`] prediction contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PredictiveDeviation {
    /// The noise and the posterior of the weights at the input. Stores p² numbers, all of which a
    /// prediction reads.
    Posterior,
    /// One number for each target: the root mean squared generalised cross-validation error.
    Gcv,
}

/// Kernel ridge regression with Gaussians on p of the samples and an unpenalised bias, fitted to
/// all of them: the "subset of regressors" (Rasmussen and Williams 2006, section 8.3.1; Nyström's
/// approximation).
///
/// It minimises ‖Y − WΦ‖² + λ tr(W K Wᵀ), with K the kernel between the centres. λ has the same
/// meaning as in [`KernelRidge`](crate::KernelRidge), and with all samples as centres the two
/// agree. It is solved for V = W L, where L Lᵀ = K + 10⁻⁶ I.
///
/// The trace holds the mean squared generalised cross-validation error of each λ of the grid, in
/// standardised units (infinite where the system is singular). The report's penalty is the chosen
/// λ.
///
/// Far from the centres the standard deviation shrinks to that of the noise, as in all models with
/// a posterior over weights.
///
/// Time grows with n·p² for the sums and p³ for each λ; memory with p².
///
/// ```
/// use phalanx_rvm::{NystromRidge, Regressor, faer::Mat, random_subset};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(1, 500, |_, t| t as f64 / 60.0);
/// let y = Mat::from_fn(1, 500, |_, t| x[(0, t)].sin());
/// let centres = random_subset(500, 40, 1); // Gaussians on 40 of the samples
/// let model = NystromRidge::default().fit_on(x.as_ref(), y.as_ref(), &centres)?.model;
/// let (mean, std) = model.predict_with_std(x.as_ref())?;
/// assert!((0..500).all(|t| (mean[(0, t)] - y[(0, t)]).abs() < 0.01 && std[(0, t)] > 0.0));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NystromRidge {
    /// Bandwidth of the kernel.
    pub bandwidth: Bandwidth,
    /// What the standard deviation contains.
    pub deviation: PredictiveDeviation,
    /// How λ is chosen. In a Gaussian process λ is the noise variance over the signal variance,
    /// whatever the number of samples: the default grid goes from almost no noise (10⁻⁴) to almost
    /// no signal (10).
    pub regularisation: NystromRegularisation,
}

impl Default for NystromRidge {
    fn default() -> Self {
        let grid = (-4..=1).map(|e| 10_f64.powi(e)).collect();
        Self {
            bandwidth: Bandwidth::Relative(1.0),
            deviation: PredictiveDeviation::Posterior,
            regularisation: NystromRegularisation::Gcv(grid),
        }
    }
}

impl NystromRidge {
    /// Largest number of centres in [`fit`](Self::fit), which takes a second or two.
    pub const CENTRES: usize = 1000;

    /// Fits X (K×I) to Y (m×I), with Gaussians on all samples if there are at most
    /// [`CENTRES`](Self::CENTRES), otherwise on a random subset of that size, drawn with a fixed
    /// seed.
    pub fn fit(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Fit> {
        self.fit_on(x, y, &random_subset(x.ncols(), Self::CENTRES, SEED))
    }

    /// Fits X (K×I) to Y (m×I) with Gaussians on the samples with these indices (ascending). Choose
    /// them with [`random_subset`]: every n-th sample of a periodic list can have the same phase.
    pub fn fit_on(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>, centres: &[usize]) -> Result<Fit> {
        self.grid()?;
        let problem = Problem::new(x, y)?;
        let samples = x.ncols();
        check::count(centres.len(), samples)?;
        check::indices("centres", centres, samples)?;
        let kernel = Kernel::Gaussian(self.bandwidth);
        let columns = BasisSpec::of(&problem, problem.features(), kernel, centres)?.centred();
        drop(problem);
        let mut sums = SufficientStatistics::new(&columns);
        for start in (0..samples).step_by(BATCH) {
            let width = BATCH.min(samples - start);
            sums.add(&columns, x.subcols(start, width), y.subcols(start, width))?;
        }
        self.fit_sums(&columns, &sums)
    }

    /// Checks the settings and the size of a problem before there are data. [`fit`](Self::fit) can
    /// still fail because of the values of the data.
    pub fn check(&self, size: ProblemSize) -> Result<()> {
        self.grid()?;
        self.bandwidth.check()?;
        stream::room(size.samples)
    }

    /// Fits sums over Gaussian columns of the same bandwidth.
    pub fn fit_sums(&self, columns: &BasisSpec, sums: &SufficientStatistics) -> Result<Fit> {
        let grid = self.grid()?;
        columns.check_kernel(Kernel::Gaussian(self.bandwidth))?;
        let equations = Summed::new(columns, sums)?;
        let whitened = Whitened::new(&equations)?;
        let errors: Vec<f64> = grid.iter().map(|&lambda| whitened.error(lambda)).collect();
        let best = (0..grid.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b]));
        let lambda = grid[best.unwrap_or(0)];
        let trace = Trace { converged: true, objective: errors };
        let model = whitened.model(lambda, self.deviation)?;
        Ok(Fit { model, report: Report::new(vec![trace], Some(lambda)) })
    }

    fn grid(&self) -> Result<&[f64]> {
        let grid = match &self.regularisation {
            NystromRegularisation::Fixed(lambda) => std::slice::from_ref(lambda),
            NystromRegularisation::Gcv(grid) => grid,
        };
        check::grid(grid)?;
        Ok(grid)
    }
}

/// The equations of columns L⁻¹φ, for which the penalty is plain ridge regression's.
struct Whitened<'a> {
    equations: &'a Summed<'a>,
    /// L with L Lᵀ = K + jitter.
    lower: Mat<f64>,
    gram: Mat<f64>,
    correlations: Mat<f64>,
}

impl<'a> Whitened<'a> {
    fn new(equations: &'a Summed<'a>) -> Result<Self> {
        let mut kernel = equations.columns().between_centres().unwrap_or_else(|| Mat::zeros(0, 0));
        let size = kernel.ncols();
        for k in 0..size {
            kernel[(k, k)] += JITTER;
        }
        let lower = linalg::cholesky(kernel).ok_or(Error::Singular { size })?;
        let mut half = equations.gram();
        linalg::lower_solve(lower.as_ref(), &mut half);
        let mut gram = half.transpose().to_owned();
        linalg::lower_solve(lower.as_ref(), &mut gram);
        let mut correlations = equations.correlations();
        linalg::lower_solve(lower.as_ref(), &mut correlations);
        Ok(Self { equations, lower, gram, correlations })
    }

    fn solve(&self, lambda: f64) -> Result<Penalised> {
        Penalised::ridge(self.gram.as_ref(), self.correlations.as_ref(), lambda)
    }

    /// Mean squared generalised cross-validation error.
    fn error(&self, lambda: f64) -> f64 {
        let Ok(solved) = self.solve(lambda) else { return f64::INFINITY };
        let (_, used) = solved.posterior();
        let (samples, targets) =
            (self.equations.samples() as f64, self.correlations.ncols() as f64);
        let left = penalised::freedom(self.equations, used);
        if left <= 0.0 {
            return f64::INFINITY;
        }
        // At the minimum the squared error is ‖Y‖² − tr(VᵀB) − λ‖V‖².
        let weights = solved.weights.as_ref();
        let explained = linalg::inner(weights, self.correlations.as_ref());
        let residual = self.equations.energy() - explained - lambda * weights.squared_norm_l2();
        samples * residual.max(0.0) / (left * left * targets)
    }

    fn model(&self, lambda: f64, deviation: PredictiveDeviation) -> Result<Model> {
        let solved = self.solve(lambda)?;
        let (mut factor, used) = solved.posterior();
        let lower = self.lower.as_ref();
        let mut weights = solved.weights;
        linalg::upper_solve(lower.transpose(), &mut weights);
        let kept: Vec<usize> = (0..lower.ncols()).collect();
        let mut noise = penalised::noise(self.equations, &kept, weights.as_ref(), used);
        let factor = match deviation {
            PredictiveDeviation::Posterior => {
                // M of the columns themselves is M L⁻¹.
                factor = factor.transpose().to_owned();
                linalg::upper_solve(lower.transpose(), &mut factor);
                CholeskyFactor::pack(kept.clone(), factor.transpose())
            }
            PredictiveDeviation::Gcv => {
                let samples = self.equations.samples() as f64;
                let left = penalised::freedom(self.equations, used);
                if left >= 1.0 {
                    for noise in &mut noise {
                        *noise *= (samples / left).sqrt();
                    }
                }
                CholeskyFactor { columns: Vec::new(), packed: Vec::new() }
            }
        };
        let posterior = Posterior::Weights(vec![factor]);
        Ok(normal_equations::model(self.equations, &kept, weights.as_ref(), &noise, posterior))
    }
}
