//! How predictions change with the inputs.

use faer::{ColRef, Mat};

use crate::linalg;
use crate::model::Model;
use crate::model::parts::Basis;
use crate::model::regressor::Regressor;

impl Model {
    /// The derivatives of the predicted targets by the inputs, m×K in the units of both, at one
    /// input of length K.
    pub(crate) fn gradient(&self, x: ColRef<'_, f64>) -> Mat<f64> {
        let parts = &self.parts;
        let scaling = parts.features.iter().zip(&parts.feature_means).zip(&parts.feature_scales);
        let z: Vec<f64> = scaling.map(|((&f, mean), scale)| (x[f] - mean) / scale).collect();
        let slopes = match &parts.basis {
            Basis::Linear => self.weights().to_owned(),
            Basis::Gaussian { beta, samples, centres } => {
                let p = samples.len();
                // φₖ = exp(−β‖z − cₖ‖²) falls along z − cₖ with slope −2β φₖ.
                let from = Mat::from_fn(p, z.len(), |k, i| z[i] - centres[i * p + k]);
                let slope: Vec<f64> = from
                    .row_iter()
                    .map(|row| row.iter().map(|v| v * v).sum::<f64>())
                    .map(|squared| -2.0 * beta * (-beta * squared).exp())
                    .collect();
                let weights = self.weights();
                let falls = Mat::from_fn(self.outputs(), p, |j, k| slope[k] * weights[(j, k)]);
                linalg::product(falls.as_ref(), from.as_ref())
            }
        };
        let mut gradient = Mat::zeros(self.outputs(), self.inputs());
        for (i, (&f, scale)) in parts.features.iter().zip(&parts.feature_scales).enumerate() {
            for j in 0..self.outputs() {
                gradient[(j, f)] = slopes[(j, i)] / scale;
            }
        }
        gradient
    }
}

#[cfg(test)]
mod tests {
    use crate::basis::kernel::{Bandwidth, Kernel};
    use crate::ridge::Ridge;
    use crate::sparse::orthogonal_least_squares::OrthogonalLeastSquares;

    use super::*;

    /// A smooth function of three inputs, one of which does not vary.
    fn data() -> (Mat<f64>, Mat<f64>) {
        let value = |i: usize, k: usize| ((3 * k + 7) * (i + 1) % 31) as f64 / 7.0;
        let x = Mat::from_fn(3, 31, |k, i| if k == 1 { 2.0 } else { value(i, k) });
        let y = Mat::from_fn(2, 31, |j, i| (x[(0, i)] + j as f64).sin() + 0.3 * x[(2, i)]);
        (x, y)
    }

    #[test]
    fn slopes_are_those_of_central_differences() {
        let (x, y) = data();
        let gaussian = OrthogonalLeastSquares {
            kernel: Kernel::Gaussian(Bandwidth::Relative(2.0)),
            count: 12,
            ..OrthogonalLeastSquares::default()
        };
        let fits = [
            Ridge::default().fit(x.as_ref(), y.as_ref()).unwrap(),
            gaussian.fit(x.as_ref(), y.as_ref()).unwrap(),
        ];
        for fit in fits {
            for sample in [0, 5, 30] {
                let slopes = fit.model.gradient(x.col(sample));
                for input in 0..3 {
                    let step = 1e-5;
                    let at = |offset: f64| {
                        let moved = Mat::from_fn(3, 1, |k, _| {
                            x[(k, sample)] + if k == input { offset } else { 0.0 }
                        });
                        fit.model.predict(moved.as_ref()).unwrap()
                    };
                    let difference = (at(step) - at(-step)) * (0.5 / step);
                    for output in 0..2 {
                        let (found, expected) = (slopes[(output, input)], difference[(output, 0)]);
                        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
                    }
                }
            }
        }
    }
}
