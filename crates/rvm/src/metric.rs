//! Distances that count what matters to a target.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::model::Basis;
use crate::principal::Principal;
use crate::problem::Problem;
use crate::sums::Sums;
use crate::{
    Block, Columns, Error, Kernel, Model, Nystrom, Projection, Result, Standardiser, check, linalg,
};

/// Learns distances between inputs from the gradients of a first regression: the expected gradient
/// outer product (Trivedi, Wang, Kpotufe and Shakhnarovich 2014; Wu, Guinney, Maggioni and Mukherjee
/// 2010), one step of a recursive feature machine (Radhakrishnan, Beaglehole, Pandit and Belkin
/// 2024).
///
/// A Gaussian on all inputs alike takes two inputs for different that differ only in what a target
/// does not depend on, and needs samples for every combination of it. So first each block of inputs
/// is reduced to its principal components, equally strong as a block; on these kernel regression is
/// fitted with all components alike; and for each group of targets
///
/// > M = mean of JᵀJ,  J = ∂(targets of the group)/∂(components) at a sample,
///
/// gives the distance (a − b)ᵀM(a − b). Of M the strongest eigenvectors are kept: a group reads few
/// numbers, which is what makes predictions fast.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct GradientMetric {
    /// The first regression.
    pub first: Nystrom,
    /// Gaussians of the first regression, at most; at least 1.
    pub centres: usize,
    /// Samples whose gradients are averaged, at most; at least 1.
    pub gradients: usize,
    /// Numbers that a group of targets reads, at most; at least 1.
    pub rank: usize,
}

/// A group of targets and what it reads.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Group {
    /// Indices of the targets.
    pub outputs: Vec<usize>,
    /// How many of the projected numbers are its own, after those of the groups before.
    pub rank: usize,
}

/// Learnt distances: Euclidean ones between the projected inputs, of which each group of targets
/// looks at its own.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Metric {
    /// From the inputs to the numbers of all groups, one group's after the other's.
    pub projection: Projection,
    /// The groups.
    pub groups: Vec<Group>,
}

impl GradientMetric {
    /// Learns from inputs `x`, K×n, made up of `blocks`, and targets `y`, m×n, in `groups` of
    /// indices.
    pub fn learn(
        &self,
        x: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
        blocks: &[Block],
        groups: &[Vec<usize>],
    ) -> Result<Metric> {
        check::count(self.rank.min(1), 1)?;
        check::count(self.gradients.min(1), 1)?;
        let (mean, principal) = components(x, blocks)?;
        let z = linalg::product(principal.as_ref(), x);
        let offset = linalg::product(
            principal.as_ref(),
            MatRef::from_column_major_slice(&mean, mean.len(), 1),
        );
        let z = Mat::from_fn(z.nrows(), z.ncols(), |d, i| z[(d, i)] - offset[(d, 0)]);
        let model = self.first_model(z.as_ref(), y)?;
        let gradients = self.gradients(&model, z.as_ref(), y)?;
        let directions = groups.par_iter().map(|outputs| self.directions(&gradients, outputs));
        let directions = directions.collect::<Result<Vec<_>>>()?;
        let ranks = directions.iter().map(Mat::nrows);
        let described = groups.iter().zip(ranks);
        let groups: Vec<Group> =
            described.map(|(outputs, rank)| Group { outputs: outputs.clone(), rank }).collect();
        let all = stacked(&directions, principal.nrows());
        let matrix = linalg::product(all.as_ref(), principal.as_ref());
        Ok(Metric { projection: Projection::about(&mean, matrix.as_ref())?, groups })
    }

    fn first_model(&self, z: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Model> {
        let problem = Problem::in_proportion(z, y)?;
        let centres = self.centres.min(z.ncols());
        check::count(centres, z.ncols())?;
        let spaced: Vec<usize> = (0..centres).map(|c| c * z.ncols() / centres).collect();
        let kernel = Kernel::Gaussian(self.first.width);
        let columns = Columns::of(&problem, problem.features(), kernel, &spaced)?.centred();
        let mut sums = Sums::new(&columns);
        sums.add(&columns, z, y)?;
        Ok(self.first.fit_sums(&columns, &sums)?.model)
    }

    /// Of each sample the gradients of all standardised targets, m×d.
    fn gradients(
        &self,
        model: &Model,
        z: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
    ) -> Result<Vec<Mat<f64>>> {
        let scale = Standardiser::fit(y)?;
        let samples = self.gradients.min(z.ncols());
        let spaced: Vec<usize> = (0..samples).map(|i| i * z.ncols() / samples).collect();
        let gradient = |&sample: &usize| {
            let mut gradient = model.gradient(z.col(sample))?;
            for (row, &scale) in scale.scale().iter().enumerate() {
                let per_deviation = if scale > 0.0 { scale.recip() } else { 0.0 };
                gradient.row_mut(row).iter_mut().for_each(|value| *value *= per_deviation);
            }
            Ok(gradient)
        };
        spaced.par_iter().map(gradient).collect()
    }

    /// The root of M of one group, rank×d.
    fn directions(&self, gradients: &[Mat<f64>], outputs: &[usize]) -> Result<Mat<f64>> {
        let (targets, d) = gradients.first().map_or((0, 0), Mat::shape);
        if let Some(&output) = outputs.iter().find(|&&output| output >= targets) {
            return Err(Error::Count { asked: output + 1, available: targets });
        }
        let each = outputs.len();
        let rows = Mat::from_fn(each * gradients.len(), d, |row, k| {
            gradients[row / each][(outputs[row % each], k)]
        });
        let eigen = linalg::eigen(linalg::gram(rows.as_ref()))?;
        let strongest = eigen.values.first().copied().unwrap_or(0.0);
        let strong = |&k: &usize| eigen.values[k] > 1e-12 * strongest;
        let kept: Vec<usize> = (0..self.rank.min(d)).filter(strong).collect();
        // Only proportions matter.
        Ok(Mat::from_fn(kept.len(), d, |r, k| {
            (eigen.values[kept[r]] / strongest).sqrt() * eigen.vectors[(k, kept[r])]
        }))
    }
}

/// The mean of all inputs, and their blocks' principal components, d×K.
fn components(x: MatRef<'_, f64>, blocks: &[Block]) -> Result<(Vec<f64>, Mat<f64>)> {
    check::length("inputs of all blocks", x.nrows(), blocks.iter().map(|b| b.inputs).sum())?;
    let starts = blocks.iter().scan(0, |next, block| {
        let start = *next;
        *next += block.inputs;
        Some((start, block))
    });
    let starts: Vec<(usize, &Block)> = starts.collect();
    let of_block = |&(start, block): &(usize, &Block)| {
        Principal::of(x.subrows(start, block.inputs), block.components)
    };
    let parts = starts.par_iter().map(of_block).collect::<Result<Vec<_>>>()?;
    let mean = parts.iter().flat_map(|part| part.mean.iter().copied()).collect();
    let all = parts.iter().map(|part| part.matrix.nrows()).sum();
    let mut joined = Mat::zeros(all, x.nrows());
    let mut row = 0;
    for ((start, block), part) in starts.into_iter().zip(&parts) {
        let rows = part.matrix.nrows();
        joined.as_mut().submatrix_mut(row, start, rows, block.inputs).copy_from(&part.matrix);
        row += rows;
    }
    Ok((mean, joined))
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

impl Model {
    /// How the predictions change with the inputs, m×K in the units of both, at one input.
    fn gradient(&self, x: faer::ColRef<'_, f64>) -> Result<Mat<f64>> {
        let parts = self.parts();
        let mut out = Mat::zeros(self.outputs(), self.inputs());
        let z: Vec<f64> = parts
            .features
            .iter()
            .enumerate()
            .map(|(i, &f)| (x[f] - parts.feature_means[i]) / parts.feature_scales[i])
            .collect();
        let weights = self.weights();
        let slopes = match &parts.basis {
            Basis::Linear => weights.to_owned(),
            Basis::Gaussian { beta, samples, centres } => {
                let p = samples.len();
                let difference = Mat::from_fn(p, z.len(), |k, i| z[i] - centres[i * p + k]);
                let falls = Mat::from_fn(self.outputs(), p, |j, k| {
                    let squared: f64 = difference.row(k).iter().map(|v| v * v).sum();
                    -2.0 * beta * (-beta * squared).exp() * weights[(j, k)]
                });
                linalg::product(falls.as_ref(), difference.as_ref())
            }
        };
        for (i, &f) in parts.features.iter().enumerate() {
            for j in 0..self.outputs() {
                out[(j, f)] = slopes[(j, i)] / parts.feature_scales[i];
            }
        }
        Ok(out)
    }
}
