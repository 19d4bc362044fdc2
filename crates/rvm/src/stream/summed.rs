//! The normal equations that sums amount to.

use faer::{Mat, MatRef};

use crate::basis::normal_equations::Equations;
use crate::basis::spec::BasisSpec;
use crate::error::{Error, Result};
use crate::linalg;
use crate::stream::SufficientStatistics;
use crate::stream::parts::UNITS;

/// Centred normal equations from sums.
pub(crate) struct Summed<'a> {
    columns: &'a BasisSpec,
    samples: usize,
    means: Vec<f64>,
    target_means: Vec<f64>,
    gram: Mat<f64>,
    correlations: Mat<f64>,
    /// ‖yⱼ‖² of each target.
    energies: Vec<f64>,
}

impl<'a> Summed<'a> {
    pub(crate) fn new(columns: &'a BasisSpec, sums: &SufficientStatistics) -> Result<Self> {
        sums.check_columns(columns)?;
        let samples = sums.samples();
        if samples == 0 {
            return Err(Error::Empty { what: "sums", rows: sums.parts.size, columns: 0 });
        }
        let (p, m) = (columns.size(), columns.outputs());
        let products = Centred::new(sums, p + m + 1);
        let means = |from: usize, count| products.means[from..from + count].to_vec();
        Ok(Self {
            columns,
            samples,
            means: means(0, p).iter().zip(columns.origins()).map(|(mean, o)| mean + o).collect(),
            target_means: means(p, m),
            gram: products.square(p),
            correlations: Mat::from_fn(p, m, |k, j| products.at(p + j, k)),
            energies: (p..p + m).map(|j| products.at(j, j).max(0.0)).collect(),
        })
    }
}

impl Equations for Summed<'_> {
    fn columns(&self) -> &BasisSpec {
        self.columns
    }

    fn samples(&self) -> usize {
        self.samples
    }

    fn means(&self) -> &[f64] {
        &self.means
    }

    fn target_means(&self) -> &[f64] {
        &self.target_means
    }

    fn gram(&self) -> Mat<f64> {
        self.gram.clone()
    }

    fn gram_column(&self, k: usize) -> Vec<f64> {
        self.gram.col_as_slice(k).to_vec()
    }

    fn gram_diagonal(&self) -> Vec<f64> {
        self.gram.diagonal().column_vector().iter().copied().collect()
    }

    fn correlations(&self) -> Mat<f64> {
        self.correlations.clone()
    }

    fn energies(&self) -> Vec<f64> {
        self.energies.clone()
    }

    fn residuals(&self, kept: &[usize], weights: MatRef<'_, f64>) -> Vec<f64> {
        let gram = linalg::submatrix(self.gram.as_ref(), kept);
        let correlations = linalg::subrows(self.correlations.as_ref(), kept);
        // ‖y − Φw‖² = ‖y‖² + wᵀ(Gw − 2b), which rounding may take below 0.
        let slope = linalg::product(gram.as_ref(), weights) - 2.0 * correlations;
        let change = |j| weights.col(j).iter().zip(slope.col(j).iter()).map(|(w, s)| w * s);
        let energies = self.energies.iter().enumerate();
        energies.map(|(j, energy)| (energy + change(j).sum::<f64>()).max(0.0)).collect()
    }
}

/// Sums of products less what the means account for: Σ ab − n āb̄. The columns were centred near
/// their means before they were summed, so that little is subtracted here.
struct Centred<'a> {
    packed: &'a [i128],
    all: usize,
    samples: f64,
    means: Vec<f64>,
}

impl<'a> Centred<'a> {
    fn new(sums: &'a SufficientStatistics, all: usize) -> Self {
        let (packed, samples) = (sums.parts.packed.as_slice(), sums.samples() as f64);
        let mut products = Self { packed, all, samples, means: Vec::new() };
        products.means = (0..all).map(|k| products.sum(all - 1, k) / samples).collect();
        products
    }

    /// Σ ab for a at or after b.
    fn sum(&self, a: usize, b: usize) -> f64 {
        self.packed[b * self.all - b * b.saturating_sub(1) / 2 + a - b] as f64 / UNITS
    }

    /// Σ ab − n āb̄ for a at or after b.
    fn at(&self, a: usize, b: usize) -> f64 {
        self.sum(a, b) - self.samples * self.means[a] * self.means[b]
    }

    /// All pairs among the first `size`.
    fn square(&self, size: usize) -> Mat<f64> {
        Mat::from_fn(size, size, |i, j| self.at(i.max(j), i.min(j)))
    }
}
