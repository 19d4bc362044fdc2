//! RVM*: a sparse model whose deviation grows away from the training samples.

use faer::{Mat, MatRef};

use crate::data::check;
use crate::data::scaler::StandardScaler;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::parts::{Basis, Posterior, known};
use crate::model::regressor::Regressor;
use crate::model::scratch::Scratch;

/// A sparse Gaussian model with the predictive variance of RVM* (Rasmussen and Quiñonero-Candela
/// 2005, *Healing the relevance vector machine through augmentation*).
///
/// Far from its vectors all columns of a sparse model are zero, and its deviation is only that of
/// the noise. RVM* adds one more Gaussian, centred on the input being predicted. Its weight has
/// mean zero and the target's variance a priori; its variance given the training samples is added:
///
/// > e²/(α + s),  s = φ*ᵀC⁻¹φ*,  e = φ*(x*) − φ(x*)ᵀΣΦᵀφ*
///
/// in units of the noise variance. The deviation thus grows from the plain one to the target's own.
/// The mean is the plain model's. All training inputs are stored, and a prediction costs as much as
/// with Gaussians on all of them. No phalanx pipeline uses it; it is for those who use this crate
/// alone.
///
/// ```
/// use phalanx_rvm::{AugmentedRvm, Regressor, RelevanceVectorMachine, faer::Mat};
///
/// # fn main() -> phalanx_rvm::Result<()> {
/// let x = Mat::from_fn(1, 60, |_, t| t as f64 / 10.0); // from 0 to 6
/// let y = Mat::from_fn(1, 60, |_, t| x[(0, t)].sin() + 0.1 * (9.0 * t as f64).sin());
/// let model = RelevanceVectorMachine::default().fit(x.as_ref(), y.as_ref())?.model;
/// let augmented = AugmentedRvm::new(model, x.as_ref(), y.as_ref())?;
///
/// let asked = Mat::from_fn(1, 2, |_, t| [3.0, 30.0][t]); // among the samples, and far from them
/// let (_, plain) = augmented.model().predict_with_std(asked.as_ref())?;
/// let (_, std) = augmented.predict_with_std(asked.as_ref())?;
/// assert!(std[(0, 0)] < 0.2 && std[(0, 1)] > 0.5);
/// assert!(plain[(0, 1)] < 0.2, "the plain deviation is too small");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AugmentedRvm {
    model: Model,
    /// Standardised features of the training samples, features×n.
    z: Mat<f64>,
    /// Centred columns at the training samples, n×p.
    phi: Mat<f64>,
    /// Variance of each target.
    variance: Vec<f64>,
}

impl AugmentedRvm {
    /// Augments a model with the samples that it was fitted to: X (K×I) and Y (m×I). The model must
    /// have Gaussian columns and a posterior over weights, as all sparse models have. (The
    /// deviation of kernel ridge already grows.)
    pub fn new(model: Model, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> Result<Self> {
        check::matrix("x", x)?;
        check::matrix("y", y)?;
        check::length("rows of x", model.inputs(), x.nrows())?;
        check::length("rows of y", model.outputs(), y.nrows())?;
        check::length("columns (samples) of y", x.ncols(), y.ncols())?;
        let parts = model.parts();
        if !matches!(
            (&parts.basis, &parts.posterior),
            (Basis::Gaussian { .. }, Posterior::Weights(_))
        ) {
            return Err(Error::NotSparse);
        }
        let mut scratch = Scratch::default();
        let (mut sample, mut mean) = (vec![0.0; x.nrows()], vec![0.0; y.nrows()]);
        let mut z = Mat::zeros(parts.features.len(), x.ncols());
        let mut phi = Mat::zeros(x.ncols(), parts.column_means.len());
        for t in 0..x.ncols() {
            sample.iter_mut().zip(x.col(t).iter()).for_each(|(s, v)| *s = *v);
            model.predict_mean_into(&sample, &mut scratch, &mut mean)?;
            z.col_as_slice_mut(t).copy_from_slice(scratch.features());
            for (k, value) in scratch.columns().iter().enumerate() {
                phi[(t, k)] = *value;
            }
        }
        let variance = StandardScaler::fit(y)?.scale().iter().map(|scale| scale * scale).collect();
        Ok(Self { model, z, phi, variance })
    }

    /// The plain model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The additional Gaussian at the training samples and at its own centre, less its mean over the
    /// training samples.
    fn star(&self, centre: &[f64], beta: f64) -> (Vec<f64>, f64) {
        let squared =
            |sample: &[f64]| sample.iter().zip(centre).map(|(s, c)| (s - c) * (s - c)).sum::<f64>();
        let n = self.z.ncols();
        let mut star: Vec<f64> =
            (0..n).map(|t| (-beta * squared(self.z.col_as_slice(t))).exp()).collect();
        let mean = star.iter().sum::<f64>() / n as f64;
        for value in &mut star {
            *value -= mean;
        }
        (star, 1.0 - mean)
    }
}

impl Regressor for AugmentedRvm {
    fn inputs(&self) -> usize {
        self.model.inputs()
    }

    fn outputs(&self) -> usize {
        self.model.outputs()
    }

    fn predict_into(
        &self,
        x: &[f64],
        scratch: &mut Scratch,
        mean: &mut [f64],
        std: &mut [f64],
    ) -> Result<()> {
        check::length("standard deviations", self.model.outputs(), std.len())?;
        self.model.predict_mean_into(x, scratch, mean)?;
        let parts = self.model.parts();
        let (Basis::Gaussian { beta, .. }, Posterior::Weights(factors)) =
            (&parts.basis, &parts.posterior)
        else {
            return Err(Error::NotSparse);
        };
        let (star, at_itself) = self.star(scratch.features(), *beta);
        let energy: f64 = star.iter().map(|v| v * v).sum();
        let shared: Vec<f64> =
            self.phi.col_iter().map(|column| dot(column.iter(), &star)).collect();
        for (j, std) in std.iter_mut().enumerate() {
            if parts.noise[j] == 0.0 {
                *std = known(0.0);
                continue;
            }
            let factor = &factors[j % factors.len()];
            let by_star = factor.times(&shared);
            let by_sample = factor.times(scratch.columns());
            let noise = parts.noise[j].powi(2);
            let plain: f64 = by_sample.iter().map(|v| v * v).sum();
            let left = (energy - by_star.iter().map(|v| v * v).sum::<f64>()).max(0.0);
            let error = at_itself - dot(by_sample.iter(), &by_star);
            // σ² e²/(α + s) with α = σ²/v.
            let added = self.variance[j] * error * error / (noise + self.variance[j] * left);
            *std = (noise * (1.0 + plain + added)).sqrt();
        }
        Ok(())
    }
}

fn dot<'a>(a: impl Iterator<Item = &'a f64>, b: &[f64]) -> f64 {
    a.zip(b).map(|(a, b)| a * b).sum()
}
