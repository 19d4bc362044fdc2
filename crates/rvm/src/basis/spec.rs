//! The basis of a regression on streamed samples, fixed before they arrive.

use faer::{Mat, MatRef};

use crate::basis::gaussians::Gaussians;
use crate::basis::kernel::{self, Bandwidth, Kernel};
use crate::data::check;
use crate::data::problem::Problem;
use crate::data::scaler::StandardScaler;
use crate::error::{Error, Result};
use crate::model::parts::Basis;

/// Origins are multiples of this. They need only be near the columns' means, and coarse ones do
/// not depend on the last bits of a machine's exponential.
const ORIGIN_STEP: f64 = 1.0 / (1 << 20) as f64;
/// Most standard deviations of the pilot that a sample may lie from its mean. Squares of such
/// numbers over as many samples as may be summed stay within the sums' range.
pub(crate) const FURTHEST: f64 = 65_536.0;
/// A small subset of the samples, known beforehand, that gives the scaling and the centres of the
/// Gaussians. Draw it with [`random_subset`](crate::random_subset).
#[derive(Debug, Clone, Copy)]
pub struct PilotSample<'a> {
    /// Inputs, K×n.
    pub x: MatRef<'a, f64>,
    /// Targets, m×n.
    pub y: MatRef<'a, f64>,
    /// Index of each of the n samples in the whole training set, as returned by
    /// [`Model::kept_samples`](crate::Model::kept_samples).
    pub samples: &'a [usize],
}

/// The basis of a regression on streamed samples: the scaling of inputs and targets, and the p
/// basis functions (columns).
///
/// It depends on the [`PilotSample`] alone, so that every machine with the pilot can add its part
/// of the stream to [`SufficientStatistics`](crate::SufficientStatistics). Inputs that are constant
/// over the pilot are ignored.
#[derive(Debug, Clone, PartialEq)]
pub struct BasisSpec {
    inputs: StandardScaler,
    targets: StandardScaler,
    kernel: Kernel,
    /// Inputs that the basis reads; they vary.
    features: Vec<usize>,
    /// `None` for linear columns, and where no input varies.
    gaussians: Option<Gaussians>,
    /// What is subtracted from each column before it is summed: near its mean.
    origins: Vec<f64>,
}

impl BasisSpec {
    /// Columns over all inputs that vary: each input, or a Gaussian on each sample of the pilot.
    pub fn new(pilot: &PilotSample<'_>, kernel: Kernel) -> Result<Self> {
        let all: Vec<usize> = (0..pilot.x.nrows()).collect();
        Self::over(pilot, kernel, &all)
    }

    /// A Gaussian on each sample of the pilot, with all inputs divided by one common scale. For
    /// inputs whose relative scales matter, such as those of a
    /// [`LearnedMetric`](crate::LearnedMetric).
    pub fn in_proportion(pilot: &PilotSample<'_>, bandwidth: Bandwidth) -> Result<Self> {
        let problem = Problem::in_proportion(pilot.x, pilot.y)?;
        Self::on_pilot(&problem, problem.features(), Kernel::Gaussian(bandwidth), pilot)
    }

    /// Columns over the inputs in `features` (ascending) that vary.
    pub fn over(pilot: &PilotSample<'_>, kernel: Kernel, features: &[usize]) -> Result<Self> {
        let problem = Problem::new(pilot.x, pilot.y)?;
        check::indices("features", features, pilot.x.nrows())?;
        let varying = problem.features();
        let features = varying.into_iter().filter(|f| features.binary_search(f).is_ok()).collect();
        Self::on_pilot(&problem, features, kernel, pilot)
    }

    fn on_pilot(
        problem: &Problem,
        features: Vec<usize>,
        kernel: Kernel,
        pilot: &PilotSample<'_>,
    ) -> Result<Self> {
        check::length("indices of the pilot's samples", pilot.x.ncols(), pilot.samples.len())?;
        let places: Vec<usize> = (0..pilot.samples.len()).collect();
        let mut columns = Self::of(problem, features, kernel, &places)?;
        if let Some(gaussians) = &mut columns.gaussians {
            gaussians.samples = pilot.samples.to_vec();
        }
        Ok(columns.centred())
    }

    /// Columns scaled by a whole problem, over `features`, all of which vary, with Gaussians on
    /// the samples `centres`. With no features there are no columns.
    pub(crate) fn of(
        problem: &Problem,
        features: Vec<usize>,
        kernel: Kernel,
        centres: &[usize],
    ) -> Result<Self> {
        kernel.check()?;
        let size = kernel::limited(match kernel {
            Kernel::Gaussian(_) if !features.is_empty() => centres.len(),
            _ => features.len(),
        })?;
        let gaussians = match kernel {
            Kernel::Gaussian(bandwidth) if !features.is_empty() => Some(Gaussians {
                beta: bandwidth.magnitude(features.len()),
                samples: centres.to_vec(),
                centres: Mat::from_fn(features.len(), size, |i, k| {
                    problem.z[(features[i], centres[k])]
                }),
            }),
            _ => None,
        };
        let (inputs, targets) = (problem.inputs.clone(), problem.targets.clone());
        Ok(Self { inputs, targets, kernel, features, gaussians, origins: vec![0.0; size] })
    }

    /// Moves the Gaussians' origins to their means over the centres. (Standardised inputs have
    /// theirs near 0.)
    pub(crate) fn centred(mut self) -> Self {
        if let Some(k) = self.between_centres() {
            let n = k.nrows() as f64;
            for (origin, column) in self.origins.iter_mut().zip(k.col_iter()) {
                *origin = (column.sum() / n / ORIGIN_STEP).round() * ORIGIN_STEP;
            }
        }
        self
    }

    /// Number of columns p.
    pub fn size(&self) -> usize {
        self.origins.len()
    }

    /// Length K of an input vector.
    pub fn inputs(&self) -> usize {
        self.inputs.scale().len()
    }

    /// Length m of a target vector.
    pub fn outputs(&self) -> usize {
        self.targets.scale().len()
    }

    /// The inputs that the columns read, ascending.
    pub fn features(&self) -> &[usize] {
        &self.features
    }

    /// The kernel that the basis was made with.
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    pub(crate) fn input_scaling(&self) -> &StandardScaler {
        &self.inputs
    }

    pub(crate) fn target_scaling(&self) -> &StandardScaler {
        &self.targets
    }

    pub(crate) fn origins(&self) -> &[f64] {
        &self.origins
    }

    /// Gaussian kernel between all pairs of centres, p×p.
    pub(crate) fn between_centres(&self) -> Option<Mat<f64>> {
        self.gaussians.as_ref().map(Gaussians::between_centres)
    }

    /// Refuses a kernel other than the one that these columns were made for.
    pub(crate) fn check_kernel(&self, fitter: Kernel) -> Result<()> {
        if self.kernel == fitter {
            return Ok(());
        }
        let [fitter, columns] = [fitter, self.kernel].map(|kernel| format!("{kernel:?}"));
        Err(Error::OtherKernel { fitter, columns })
    }

    /// The features and the basis of a model that keeps only the columns `kept`.
    pub(crate) fn keep(&self, kept: &[usize]) -> (Vec<usize>, Basis) {
        let Some(Gaussians { beta, samples, centres }) = &self.gaussians else {
            return (kept.iter().map(|&k| self.features[k]).collect(), Basis::Linear);
        };
        if kept.is_empty() {
            return (Vec::new(), Basis::Linear);
        }
        let rows = 0..self.features.len();
        let centres = rows.flat_map(|f| kept.iter().map(move |&k| centres[(f, k)])).collect();
        let samples = kept.iter().map(|&k| samples[k]).collect();
        (self.features.clone(), Basis::Gaussian { beta: *beta, samples, centres })
    }

    /// Refuses values that are not finite, or implausibly far from the pilot's samples: one of them
    /// would outweigh all others, and sums could overflow.
    pub(crate) fn check_samples(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<()> {
        check::matrix("x", x)?;
        check::matrix("y", y)?;
        check::length("rows of x", self.inputs(), x.nrows())?;
        check::length("rows of y", self.outputs(), y.nrows())?;
        check::length("columns (samples) of y", x.ncols(), y.ncols())?;
        near("x", x, &self.inputs, &self.features)?;
        near("y", y, &self.targets, &(0..y.nrows()).collect::<Vec<_>>())
    }

    /// A hash (FNV-1a) of everything that defines the basis, so that sums over different bases are
    /// not merged.
    pub(crate) fn fingerprint(&self) -> u64 {
        let scalings = [&self.inputs, &self.targets];
        let scalings = scalings.into_iter().flat_map(|s| s.mean().iter().chain(s.scale()));
        let features = self.features.iter().map(|&f| f as u64);
        let mut words: Vec<u64> = scalings.map(|v| v.to_bits()).chain(features).collect();
        if let Some(Gaussians { beta, samples, centres }) = &self.gaussians {
            words.push(beta.to_bits());
            words.extend(samples.iter().map(|&s| s as u64));
            words.extend(centres.col_iter().flat_map(faer::ColRef::iter).map(|v| v.to_bits()));
        }
        words
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
                (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
            })
    }

    /// The p columns less their origins, the m standardised targets and a column of ones, n×(p +
    /// m + 1), for inputs K×n and targets m×n.
    pub(crate) fn evaluate(&self, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Mat<f64> {
        let (n, p, m) = (x.ncols(), self.size(), self.outputs());
        let z = Mat::from_fn(self.features.len(), n, |i, t| {
            self.inputs.scaled(self.features[i], x[(self.features[i], t)])
        });
        let mut out = Mat::from_fn(n, p + m + 1, |t, k| match k.checked_sub(p) {
            Some(j) if j < m => self.targets.scaled(j, y[(j, t)]),
            Some(_) => 1.0,
            None if self.gaussians.is_none() => z[(k, t)],
            None => 0.0,
        });
        if let Some(gaussians) = &self.gaussians {
            gaussians.evaluate(z.as_ref(), &self.origins, out.as_mut().subcols_mut(0, p));
        }
        out
    }
}

/// Refuses entries of `rows` that lie too far from the pilot's mean. What did not vary there may
/// vary by rounding.
fn near(
    what: &'static str,
    samples: MatRef<'_, f64>,
    pilot: &StandardScaler,
    rows: &[usize],
) -> Result<()> {
    for column in 0..samples.ncols() {
        for &row in rows {
            let value = samples[(row, column)];
            if pilot.deviations(row, value) <= FURTHEST {
                continue;
            }
            return Err(if pilot.scale()[row] > 0.0 {
                Error::FarFromPilot { what, row, column, value }
            } else {
                Error::ConstantInPilot { what, row, column, value }
            });
        }
    }
    Ok(())
}
