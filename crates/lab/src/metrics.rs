//! Errors of estimates, as the paper reports them.

use faer::{Mat, MatRef};
use phalanx_hand::Dof;

/// Absolute errors over test samples, degrees, dof by dof.
#[derive(Clone)]
pub(crate) struct AngleErrors {
    dofs: Vec<Dof>,
    /// Mean over the test samples, one per dof.
    mean: Vec<f64>,
    /// Standard deviation over the test samples, one per dof.
    std: Vec<f64>,
}

impl AngleErrors {
    /// Compares estimates with the truth, both 28 × I in radians, over the angles `dofs`.
    pub(crate) fn new(estimates: MatRef<'_, f64>, truth: MatRef<'_, f64>, dofs: &[Dof]) -> Self {
        let samples = truth.ncols() as f64;
        let (mut mean, mut std) = (Vec::new(), Vec::new());
        for dof in dofs {
            let row = dof.index();
            let errors: Vec<f64> = (0..truth.ncols())
                .map(|i| (estimates[(row, i)] - truth[(row, i)]).abs().to_degrees())
                .collect();
            let average = errors.iter().sum::<f64>() / samples;
            let variance = errors.iter().map(|e| (e - average).powi(2)).sum::<f64>() / samples;
            mean.push(average);
            std.push(variance.sqrt());
        }
        Self { dofs: dofs.to_vec(), mean, std }
    }

    /// The mean of several runs over the same dofs.
    pub(crate) fn average(runs: &[Self]) -> Self {
        let mean_of = |field: fn(&Self) -> &[f64], dof: usize| {
            runs.iter().map(|run| field(run)[dof]).sum::<f64>() / runs.len() as f64
        };
        let dofs = runs[0].dofs.clone();
        let each =
            |field: fn(&Self) -> &[f64]| (0..dofs.len()).map(|d| mean_of(field, d)).collect();
        Self { mean: each(|run| &run.mean), std: each(|run| &run.std), dofs }
    }

    /// Mean absolute error over samples and dofs, degrees.
    pub(crate) fn mae(&self) -> f64 {
        self.mean.iter().sum::<f64>() / self.mean.len() as f64
    }

    /// Mean over dofs of the standard deviation of the absolute error, degrees.
    pub(crate) fn std(&self) -> f64 {
        self.std.iter().sum::<f64>() / self.std.len() as f64
    }

    /// Mean and standard deviation of one of the dofs' absolute errors, degrees.
    pub(crate) fn of(&self, dof: Dof) -> Option<(f64, f64)> {
        let k = self.dofs.iter().position(|&of| of == dof)?;
        Some((self.mean[k], self.std[k]))
    }

    /// The dof with the largest mean error, and that error in degrees.
    pub(crate) fn worst(&self) -> (Dof, f64) {
        let pairs = self.dofs.iter().copied().zip(self.mean.iter().copied());
        pairs.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a data set has active angles")
    }
}

/// The mean of the targets' columns, once for each of `samples`: what guessing without looking
/// gives.
pub(crate) fn mean_predictor(targets: &Mat<f64>, samples: usize) -> Mat<f64> {
    let mean = |row: usize| {
        (0..targets.ncols()).map(|i| targets[(row, i)]).sum::<f64>() / targets.ncols() as f64
    };
    let means: Vec<f64> = (0..targets.nrows()).map(mean).collect();
    Mat::from_fn(targets.nrows(), samples, |row, _| means[row])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_a_worked_example() {
        let degrees = |dof: Dof, values: [f64; 2]| (dof.index(), values.map(f64::to_radians));
        let matrix = |rows: &[(usize, [f64; 2])]| {
            let mut matrix = Mat::zeros(Dof::COUNT, 2);
            for &(row, values) in rows {
                matrix[(row, 0)] = values[0];
                matrix[(row, 1)] = values[1];
            }
            matrix
        };
        let truth = matrix(&[]);
        let estimates =
            matrix(&[degrees(Dof::IndexPip, [1.0, -3.0]), degrees(Dof::ThetaZ, [10.0, 10.0])]);
        let dofs = [Dof::IndexPip, Dof::ThetaZ];
        let errors = AngleErrors::new(estimates.as_ref(), truth.as_ref(), &dofs);
        assert!((errors.mae() - 6.0).abs() < 1e-12, "mean of 2 and 10");
        assert!((errors.std() - 0.5).abs() < 1e-12, "mean of 1 and 0");
        assert_eq!(errors.worst().0, Dof::ThetaZ);
        let twice = AngleErrors::average(&[errors.clone(), errors.clone()]);
        assert!((twice.mae() - errors.mae()).abs() < 1e-12);
    }
}
