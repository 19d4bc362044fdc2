//! The problems that gen_data.py writes.

use std::path::Path;

use anyhow::{Context, Result};
use phalanx_rvm::faer::{Mat, MatRef};

/// A problem of regression; samples are columns.
pub(crate) struct Problem {
    pub(crate) x: Mat<f64>,
    pub(crate) y: Mat<f64>,
    pub(crate) test_x: Mat<f64>,
    /// Without noise.
    pub(crate) test_y: Mat<f64>,
}

impl Problem {
    pub(crate) fn read(folder: &Path, name: &str) -> Result<Self> {
        let part = |part| matrix(&folder.join(format!("{name}_{part}.csv")));
        Ok(Self { x: part("x")?, y: part("y")?, test_x: part("xt")?, test_y: part("yt")? })
    }

    /// The mean of the inputs' variances.
    pub(crate) fn variance(&self) -> f64 {
        let of_row = |row: usize| {
            let values = (0..self.x.ncols()).map(|t| self.x[(row, t)]);
            let mean = values.clone().sum::<f64>() / self.x.ncols() as f64;
            values.map(|v| (v - mean).powi(2)).sum::<f64>() / self.x.ncols() as f64
        };
        (0..self.x.nrows()).map(of_row).sum::<f64>() / self.x.nrows() as f64
    }

    /// Root of the mean squared error of a prediction of the test samples.
    pub(crate) fn rmse(&self, prediction: MatRef<'_, f64>) -> f64 {
        (prediction - &self.test_y).norm_l2()
            / (self.test_y.nrows() as f64 * self.test_y.ncols() as f64).sqrt()
    }

    /// Mean absolute error of a prediction of the test samples.
    pub(crate) fn mean_error(&self, prediction: MatRef<'_, f64>) -> f64 {
        (prediction - &self.test_y).norm_l1() / (self.test_y.nrows() * self.test_y.ncols()) as f64
    }
}

/// A CSV of numbers, a sample a line, as a matrix with a sample a column.
pub(crate) fn matrix(path: &Path) -> Result<Mat<f64>> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let rows: Vec<Vec<f64>> = text
        .lines()
        .map(|line| line.split(',').map(|v| v.trim().parse()).collect::<Result<_, _>>())
        .collect::<Result<_, _>>()
        .with_context(|| path.display().to_string())?;
    let width = rows.first().map_or(0, Vec::len);
    anyhow::ensure!(rows.iter().all(|row| row.len() == width), "{}: ragged", path.display());
    Ok(Mat::from_fn(width, rows.len(), |i, t| rows[t][i]))
}
