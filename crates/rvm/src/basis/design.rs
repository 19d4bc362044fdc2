//! All samples' basis columns in memory.

use faer::{Mat, MatRef};

use crate::basis::kernel::Kernel;
use crate::basis::normal_equations::Equations;
use crate::basis::spec::BasisSpec;
use crate::data::problem::Problem;
use crate::error::Result;
use crate::linalg;

/// The centred basis columns of a problem, with Gaussians on all of its samples.
pub(crate) struct Design<'a> {
    problem: &'a Problem,
    columns: BasisSpec,
    /// Φ: one centred basis function per column, I×p.
    pub(crate) phi: Mat<f64>,
    /// What was subtracted from each column.
    means: Vec<f64>,
    target_means: Vec<f64>,
}

impl<'a> Design<'a> {
    /// Basis columns over `features`, all of which vary. With none there are no columns.
    pub(crate) fn new(problem: &'a Problem, features: Vec<usize>, kernel: Kernel) -> Result<Self> {
        let all: Vec<usize> = (0..problem.z.ncols()).collect();
        let columns = BasisSpec::of(problem, features, kernel, &all)?;
        let mut phi = columns.between_centres().unwrap_or_else(|| {
            linalg::subrows(problem.z.as_ref(), columns.features()).transpose().to_owned()
        });
        // This stands for an unpenalised bias.
        let means = linalg::centre(&mut phi);
        Ok(Self { problem, columns, phi, means, target_means: vec![0.0; problem.y.ncols()] })
    }

    /// The basis over every input that varies.
    pub(crate) fn full(problem: &'a Problem, kernel: Kernel) -> Result<Self> {
        Self::new(problem, problem.features(), kernel)
    }

    /// Number of basis columns.
    pub(crate) fn size(&self) -> usize {
        self.phi.ncols()
    }

    /// Standardised targets, I×m.
    pub(crate) fn targets(&self) -> MatRef<'_, f64> {
        self.problem.y.as_ref()
    }
}

impl Equations for Design<'_> {
    fn columns(&self) -> &BasisSpec {
        &self.columns
    }

    fn samples(&self) -> usize {
        self.phi.nrows()
    }

    fn means(&self) -> &[f64] {
        &self.means
    }

    fn target_means(&self) -> &[f64] {
        &self.target_means
    }

    fn gram(&self) -> Mat<f64> {
        linalg::gram(self.phi.as_ref())
    }

    fn gram_column(&self, k: usize) -> Vec<f64> {
        linalg::product(self.phi.transpose(), self.phi.subcols(k, 1)).col_as_slice(0).to_vec()
    }

    fn gram_diagonal(&self) -> Vec<f64> {
        self.phi.col_iter().map(|column| column.squared_norm_l2()).collect()
    }

    fn correlations(&self) -> Mat<f64> {
        linalg::product(self.phi.transpose(), self.targets())
    }

    fn energies(&self) -> Vec<f64> {
        self.targets().col_iter().map(|target| target.squared_norm_l2()).collect()
    }

    fn residuals(&self, kept: &[usize], weights: MatRef<'_, f64>) -> Vec<f64> {
        let phi = Mat::from_fn(self.samples(), kept.len(), |i, k| self.phi[(i, kept[k])]);
        let residuals = self.targets() - linalg::product(phi.as_ref(), weights);
        residuals.col_iter().map(|column| column.iter().map(|r| r * r).sum()).collect()
    }
}
