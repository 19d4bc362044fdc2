//! The inputs' common scale.

use faer::{ColRef, MatRef};

/// Scaling of the inputs to means of 0 and a mean variance of 1.
pub(super) struct Scaling {
    pub(super) mean: Vec<f64>,
    /// The common factor; 0 if no input varies.
    pub(super) factor: f64,
}

impl Scaling {
    pub(super) fn of(x: MatRef<'_, f32>) -> Self {
        let count = x.ncols() as f64;
        let mut mean = vec![0.0; x.nrows()];
        for column in x.col_iter() {
            mean.iter_mut().zip(column.iter()).for_each(|(sum, &v)| *sum += f64::from(v) / count);
        }
        let offset = |column: ColRef<'_, f32>| -> f64 {
            column.iter().zip(&mean).map(|(&v, mean)| (f64::from(v) - mean).powi(2)).sum()
        };
        let squares: f64 = x.col_iter().map(offset).sum();
        let variance = squares / (count * x.nrows() as f64);
        let factor = if variance > 0.0 { variance.sqrt().recip() } else { 0.0 };
        Self { mean, factor }
    }
}
