//! From raw matrices to the centred basis columns that every solver works on, and back to a model.

use faer::{Mat, MatRef};

use crate::model::{Basis, Model, ModelParts, Posterior};
use crate::{Error, Kernel, Result, Standardiser, check, kernel, linalg};

/// Most basis columns of a dense solver: one square matrix over them takes 0.8 GB.
const MOST_COLUMNS: usize = 10_000;

/// Training data, checked and standardised.
pub(crate) struct Problem {
    inputs: Standardiser,
    targets: Standardiser,
    /// Standardised inputs, K×I.
    z: Mat<f64>,
    /// Standardised targets, samples in rows: I×m.
    y: Mat<f64>,
}

impl Problem {
    pub(crate) fn new(x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Self> {
        let inputs = Standardiser::fit(x)?;
        check::matrix("y", y)?;
        check::length("columns (samples) of y", x.ncols(), y.ncols())?;
        let targets = Standardiser::fit(y)?;
        let z = inputs.apply(x)?;
        let y = targets.apply(y)?.transpose().to_owned();
        Ok(Self { inputs, targets, z, y })
    }

    /// The inputs that vary.
    pub(crate) fn features(&self) -> Vec<usize> {
        self.inputs.varying()
    }
}

/// The basis columns of a problem and what they are columns of.
pub(crate) struct Design<'a> {
    problem: &'a Problem,
    /// Inputs that the basis reads.
    features: Vec<usize>,
    /// |β| of Gaussian columns; `None` for linear ones.
    beta: Option<f64>,
    /// Φ: one centred basis function per column, I×p.
    pub(crate) columns: Mat<f64>,
    /// What was subtracted from each column.
    pub(crate) means: Vec<f64>,
}

impl<'a> Design<'a> {
    /// Basis columns over `features`, all of which vary. With none there are no columns.
    pub(crate) fn new(problem: &'a Problem, features: Vec<usize>, kernel: Kernel) -> Result<Self> {
        kernel.check()?;
        let z = linalg::subrows(problem.z.as_ref(), &features);
        let size = match kernel {
            Kernel::Linear => features.len(),
            Kernel::Gaussian(_) => z.ncols(),
        };
        if size > MOST_COLUMNS {
            return Err(Error::TooManyColumns { columns: size, limit: MOST_COLUMNS });
        }
        let (beta, mut columns) = match kernel {
            Kernel::Linear => (None, z.transpose().to_owned()),
            Kernel::Gaussian(_) if features.is_empty() => (None, Mat::zeros(z.ncols(), 0)),
            Kernel::Gaussian(width) => {
                let beta = width.magnitude(features.len());
                (Some(beta), kernel::gaussian(z.as_ref(), beta))
            }
        };
        let means = centre(&mut columns);
        Ok(Self { problem, features, beta, columns, means })
    }

    /// The basis over every input that varies.
    pub(crate) fn full(problem: &'a Problem, kernel: Kernel) -> Result<Self> {
        Self::new(problem, problem.features(), kernel)
    }

    /// Inputs that the basis reads.
    pub(crate) fn features(&self) -> &[usize] {
        &self.features
    }

    /// Number of basis columns.
    pub(crate) fn size(&self) -> usize {
        self.columns.ncols()
    }

    /// Standardised targets, I×m.
    pub(crate) fn targets(&self) -> MatRef<'_, f64> {
        self.problem.y.as_ref()
    }

    /// G = ΦᵀΦ (the paper's F Fᵀ).
    pub(crate) fn gram(&self) -> Mat<f64> {
        linalg::gram(self.columns.as_ref())
    }

    /// B = ΦᵀYᵀ, p×m.
    pub(crate) fn correlations(&self) -> Mat<f64> {
        linalg::product(self.columns.transpose(), self.targets())
    }

    /// The model on the columns `kept` with standardised `weights` (kept×m), standardised noise
    /// deviations per target and the posterior over `kept`.
    pub(crate) fn model(
        &self,
        kept: &[usize],
        weights: MatRef<'_, f64>,
        noise: &[f64],
        posterior: Posterior,
    ) -> Model {
        let Problem { inputs, targets, z, .. } = self.problem;
        let (features, basis) = match self.beta {
            None => (kept.iter().map(|&k| self.features[k]).collect(), Basis::Linear),
            Some(_) if kept.is_empty() => (Vec::new(), Basis::Linear),
            Some(beta) => {
                let read = &self.features;
                let centres =
                    read.iter().flat_map(|&f| kept.iter().map(move |&s| z[(f, s)])).collect();
                (read.clone(), Basis::Gaussian { beta, samples: kept.to_vec(), centres })
            }
        };
        let scale = targets.scale();
        let parts = ModelParts {
            inputs: z.nrows(),
            outputs: scale.len(),
            feature_means: features.iter().map(|&f| inputs.mean()[f]).collect(),
            feature_scales: features.iter().map(|&f| inputs.scale()[f]).collect(),
            features,
            basis,
            column_means: kept.iter().map(|&k| self.means[k]).collect(),
            weights: (0..kept.len())
                .flat_map(|k| scale.iter().enumerate().map(move |(j, s)| s * weights[(k, j)]))
                .collect(),
            bias: targets.mean().to_vec(),
            noise: scale.iter().zip(noise).map(|(s, noise)| s * noise).collect(),
            posterior,
        };
        Model::trusted(parts)
    }
}

/// Subtracts its mean from each column, which stands for an unpenalised bias.
fn centre(columns: &mut Mat<f64>) -> Vec<f64> {
    (0..columns.ncols())
        .map(|j| {
            let column = columns.col_as_slice_mut(j);
            let mean = column.iter().sum::<f64>() / column.len() as f64;
            for value in &mut *column {
                *value -= mean;
            }
            mean
        })
        .collect()
}
