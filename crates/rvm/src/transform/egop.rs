//! Distances learned from gradients.

use faer::{Mat, MatRef};
use phalanx_sampling::random_subset;
use rayon::prelude::*;

use crate::basis::kernel::{self, Kernel};
use crate::basis::spec::BasisSpec;
use crate::data::check;
use crate::data::problem::Problem;
use crate::data::scaler::StandardScaler;
use crate::data::size::ProblemSize;
use crate::error::{Error, Result};
use crate::linalg;
use crate::model::Model;
use crate::ridge::nystrom::NystromRidge;
use crate::stream::SufficientStatistics;
use crate::transform::affine_map::AffineMap;
use crate::transform::block_pca::BlockPca;
use crate::transform::learned_metric::{LearnedMetric, TargetGroup};
use crate::transform::pca::{FeatureBlock, Pca, of_blocks};

/// Seeds of the choice of centres, and of the samples whose gradients are averaged.
const CENTRE_SEED: u64 = 0;
const GRADIENT_SEED: u64 = 1;

/// Learns distances between inputs from the gradients of a regression: the expected gradient outer
/// product (Trivedi, Wang, Kpotufe and Shakhnarovich 2014; Wu, Guinney, Maggioni and Mukherjee
/// 2010), which is one step of a recursive feature machine (Radhakrishnan, Beaglehole, Pandit and
/// Belkin 2024).
///
/// A Gaussian kernel over all inputs also responds to directions that do not matter to a target,
/// and so needs samples for all their combinations. Here each block of inputs is first reduced to
/// its principal components and scaled to the same total variance. A kernel regression is fitted to
/// these. For each group of targets,
///
/// > M = mean of JᵀJ,  J = ∂(targets of the group)/∂(components) at a sample,
///
/// gives the distance (a − b)ᵀM(a − b). In further rounds a regression in that distance gives the
/// next one. Only the strongest eigenvectors of M are kept, so that each group reads few numbers
/// and predictions are fast.
///
/// ```
/// use phalanx_rvm::{
///     ExpectedGradientOuterProduct, FeatureBlock, GroupedRegressor, NystromRidge, Regressor, faer::Mat,
/// };
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(6, 400, |i, t| ((t * (3 + i * i)) as f64 * 0.618).fract());
/// let y = Mat::from_fn(1, 400, |_, t| (4.0 * (x[(1, t)] + x[(2, t)])).sin());
/// let nystrom = NystromRidge::default();
/// let learning =
///     ExpectedGradientOuterProduct { regression: nystrom.clone(), rounds: 2, centres: 100, gradients: 400, rank: 1 };
/// let blocks = [FeatureBlock { inputs: 6, components: 6 }];
/// let metric = learning.fit(x.as_ref(), y.as_ref(), &blocks, &[vec![0]])?;
///
/// // Of six inputs one number is left, and from it the target follows.
/// let z = metric.projection.apply(x.as_ref())?;
/// assert_eq!(z.nrows(), 1);
/// let model = nystrom.fit(z.as_ref(), y.as_ref())?.model;
/// let all = GroupedRegressor::from_parts(metric, vec![model])?;
/// assert_eq!((all.inputs(), all.outputs()), (6, 1));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExpectedGradientOuterProduct {
    /// The regression whose gradients are taken.
    pub regression: NystromRidge,
    /// Number of rounds, at least 1.
    pub rounds: usize,
    /// Maximum number of Gaussians, at least 1; a random subset of the samples.
    pub centres: usize,
    /// Maximum number of samples whose gradients are averaged, at least 1; a random subset.
    pub gradients: usize,
    /// Maximum number of directions that a group of targets reads, at least 1. Before the last
    /// round it may read [`WIDER`](Self::WIDER) times as many.
    pub rank: usize,
}

impl ExpectedGradientOuterProduct {
    /// Factor by which the rank may be larger before the last round.
    pub const WIDER: usize = 3;

    /// Fits X (K×I), whose rows are made up of `blocks`, to Y (m×I), whose rows are in `groups` of
    /// indices.
    pub fn fit(
        &self,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
        blocks: &[FeatureBlock],
        groups: &[Vec<usize>],
    ) -> Result<LearnedMetric> {
        Ok(self.fit_with_components(x, y, blocks, groups)?.0)
    }

    /// Like [`fit`](Self::fit), with the principal components that the distances are learned between.
    pub fn fit_with_components(
        &self,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
        blocks: &[FeatureBlock],
        groups: &[Vec<usize>],
    ) -> Result<(LearnedMetric, BlockPca)> {
        self.check(ProblemSize::of(x, y))?;
        check::matrix("y", y)?;
        check::length("columns (samples) of y", x.ncols(), y.ncols())?;
        if let Some(&output) = groups.iter().flatten().find(|&&output| output >= y.nrows()) {
            return Err(Error::Index { what: "groups", index: output, available: y.nrows() });
        }
        let parts = of_blocks(x, blocks)?;
        let (mean, principal) = joined(&parts, x.nrows());
        let z = centred_product(principal.as_ref(), x, &mean);
        let gradients = self.gradients(z.as_ref(), y)?;
        let learnt = groups.par_iter().map(|outputs| {
            let first = Self::directions(&of_group(&gradients, outputs), self.width(1));
            self.further(first?, z.as_ref(), linalg::subrows(y, outputs).as_ref())
        });
        let directions = learnt.collect::<Result<Vec<_>>>()?;
        let ranks = directions.iter().map(Mat::nrows);
        let described = groups.iter().zip(ranks);
        let groups: Vec<TargetGroup> = described
            .map(|(outputs, rank)| TargetGroup { outputs: outputs.clone(), rank })
            .collect();
        let all = stacked(&directions, principal.nrows());
        let matrix = linalg::product(all.as_ref(), principal.as_ref());
        let projection = AffineMap::about(&mean, matrix.as_ref())?;
        Ok((LearnedMetric { projection, groups }, BlockPca::of(&parts)?))
    }

    /// Checks the settings and the size of a problem before there are data. [`fit`](Self::fit) can
    /// still fail because of the values of the data.
    pub fn check(&self, size: ProblemSize) -> Result<()> {
        for count in [self.rounds, self.rank, self.gradients, self.centres] {
            check::count(count.min(1), 1)?;
        }
        self.regression.check(size)?;
        kernel::limited(self.centres.min(size.samples)).map(drop)
    }

    /// Numbers that a group may read after this round.
    fn width(&self, round: usize) -> usize {
        if round < self.rounds { self.rank.saturating_mul(Self::WIDER) } else { self.rank }
    }

    /// The rounds after the first, of a group with targets `y`: from its directions, rank×d, to those
    /// that it keeps.
    fn further(
        &self,
        mut directions: Mat<f64>,
        z: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
    ) -> Result<Mat<f64>> {
        for round in 2..=self.rounds {
            if directions.nrows() == 0 {
                break;
            }
            let own = linalg::product(directions.as_ref(), z);
            let gradients = self.gradients(own.as_ref(), y)?;
            let next = Self::directions(&gradients, self.width(round))?;
            directions = linalg::product(next.as_ref(), directions.as_ref());
        }
        Ok(directions)
    }

    /// Of each sample the gradients of all standardised targets, m×d.
    fn gradients(&self, z: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Vec<Mat<f64>>> {
        let model = self.model(z, y)?;
        let scale = StandardScaler::fit(y)?;
        let samples = random_subset(z.ncols(), self.gradients, GRADIENT_SEED);
        let gradient = |&sample: &usize| {
            let mut gradient = model.gradient(z.col(sample));
            for (row, &scale) in scale.scale().iter().enumerate() {
                let per_deviation = if scale > 0.0 { scale.recip() } else { 0.0 };
                gradient.row_mut(row).iter_mut().for_each(|value| *value *= per_deviation);
            }
            gradient
        };
        Ok(samples.par_iter().map(gradient).collect())
    }

    /// The regression on inputs that keep their proportions.
    fn model(&self, z: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Model> {
        let problem = Problem::in_proportion(z, y)?;
        let centres = random_subset(z.ncols(), self.centres, CENTRE_SEED);
        check::count(centres.len(), z.ncols())?;
        let kernel = Kernel::Gaussian(self.regression.bandwidth);
        let columns = BasisSpec::of(&problem, problem.features(), kernel, &centres)?.centred();
        let mut sums = SufficientStatistics::new(&columns);
        sums.add(&columns, z, y)?;
        Ok(self.regression.fit_sums(&columns, &sums)?.model)
    }

    /// The root of M, at most so many rows.
    fn directions(gradients: &[Mat<f64>], most: usize) -> Result<Mat<f64>> {
        let d = gradients.first().map_or(0, Mat::ncols);
        let eigen = linalg::eigen(&linalg::gram(stacked(gradients, d).as_ref()))?;
        let strongest = eigen.values.first().copied().unwrap_or(0.0);
        let strong = |&k: &usize| eigen.values[k] > 1e-12 * strongest;
        let kept: Vec<usize> = (0..most.min(d)).filter(strong).collect();
        // Only proportions matter.
        Ok(Mat::from_fn(kept.len(), d, |r, k| {
            (eigen.values[kept[r]] / strongest).sqrt() * eigen.vectors[(k, kept[r])]
        }))
    }
}

/// The gradients of some of the targets.
fn of_group(gradients: &[Mat<f64>], outputs: &[usize]) -> Vec<Mat<f64>> {
    gradients.iter().map(|gradient| linalg::subrows(gradient.as_ref(), outputs)).collect()
}

/// A (x − mean) for each column of `x`.
fn centred_product(a: MatRef<'_, f64>, x: MatRef<'_, f64>, mean: &[f64]) -> Mat<f64> {
    let mut z = linalg::product(a, x);
    let offset = linalg::product(a, MatRef::from_column_major_slice(mean, mean.len(), 1));
    for i in 0..z.ncols() {
        linalg::axpy(z.col_as_slice_mut(i), -1.0, offset.col_as_slice(0));
    }
    z
}

/// The mean of all K inputs, and their blocks' principal components, d×K.
fn joined(parts: &[Pca], inputs: usize) -> (Vec<f64>, Mat<f64>) {
    let mean = parts.iter().flat_map(|part| part.mean.iter().copied()).collect();
    let all = parts.iter().map(|part| part.matrix.nrows()).sum();
    let mut joined = Mat::zeros(all, inputs);
    let (mut row, mut column) = (0, 0);
    for part in parts {
        let (rows, columns) = part.matrix.shape();
        joined.as_mut().submatrix_mut(row, column, rows, columns).copy_from(&part.matrix);
        (row, column) = (row + rows, column + columns);
    }
    (mean, joined)
}

/// Matrices of d columns, one below the other.
fn stacked(parts: &[Mat<f64>], d: usize) -> Mat<f64> {
    let mut all = Mat::zeros(parts.iter().map(Mat::nrows).sum(), d);
    let mut row = 0;
    for part in parts {
        all.as_mut().subrows_mut(row, part.nrows()).copy_from(part);
        row += part.nrows();
    }
    all
}
