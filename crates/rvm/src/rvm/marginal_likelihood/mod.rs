//! The evidence of targets that share their relevant columns, and the rank-one steps that raise it.

mod active;
pub(crate) mod ascent;
mod posterior;
mod steps;
pub(crate) mod targets;
#[cfg(test)]
mod tests;

use faer::Mat;

use crate::error::Result;
use crate::linalg;
use crate::rvm::marginal_likelihood::active::Active;
use crate::rvm::marginal_likelihood::posterior::Posterior;
use crate::rvm::marginal_likelihood::targets::Targets;

/// First guess of the noise, as a share of a target's variance.
const FIRST_NOISE: f64 = 0.1;

/// State of Tipping and Faul's (2003) algorithm for targets that share their precisions, with
/// their symbols.
///
/// The weights' prior is relative to the noise: wᵢⱼ ~ N(0, σⱼ²/αᵢ), as in Ha and Zhang (2017).
/// Then target j is distributed as N(0, σⱼ²C) with one C = I + ΦA⁻¹Φᵀ, and the targets share Σ
/// and S while the noise stands apart from both: a new σⱼ² changes neither. For one target this is
/// Tipping and Faul's own model with α/σ² written for α.
#[derive(Clone)]
pub(crate) struct MarginalLikelihood<'a> {
    targets: Targets<'a>,
    /// Least noise variance.
    floor: f64,
    /// Most active columns.
    most: usize,
    /// Log evidence that each active column must add, in nats.
    min_evidence_gain: f64,
    /// Noise variance σⱼ².
    noise: Vec<f64>,
    active: Active,
    /// φᵀC⁻¹φ of every column φ.
    sparsity: Vec<f64>,
    /// φᵀC⁻¹yⱼ, p×m.
    quality: Mat<f64>,
    /// yⱼᵀC⁻¹yⱼ.
    misfit: Vec<f64>,
    /// log |C|.
    log_determinant: f64,
    /// Steps since all of this was last computed from scratch.
    stale: usize,
}

impl<'a> MarginalLikelihood<'a> {
    /// Starts with no column active.
    pub(crate) fn new(
        targets: Targets<'a>,
        floor: f64,
        most: usize,
        min_evidence_gain: f64,
    ) -> Result<Self> {
        let (p, m) = targets.correlations.shape();
        let mut evidence = Self {
            targets,
            floor,
            most,
            min_evidence_gain,
            noise: vec![1.0; m],
            active: Active::none(p, m),
            sparsity: vec![0.0; p],
            quality: Mat::zeros(p, m),
            misfit: vec![0.0; m],
            log_determinant: 0.0,
            stale: 0,
        };
        evidence.refresh()?;
        evidence.update_noise();
        evidence.noise.iter_mut().for_each(|noise| *noise = (FIRST_NOISE * *noise).max(floor));
        Ok(evidence)
    }

    fn posterior(&self) -> Result<Posterior> {
        Posterior::of(&self.active, &self.targets)
    }

    /// Computes everything anew from the active columns and their precisions.
    pub(super) fn refresh(&mut self) -> Result<()> {
        let Posterior { factor, mu, misfit, log_determinant } = self.posterior()?;
        let gram = self.targets.gram;
        for (k, s) in self.sparsity.iter_mut().enumerate() {
            *s = gram[(k, k)];
        }
        let overlap = linalg::times_upper(self.active.gram.as_ref(), factor.transpose());
        for column in overlap.col_iter() {
            self.sparsity.iter_mut().zip(column.iter()).for_each(|(s, c)| *s -= c * c);
        }
        self.quality =
            self.targets.correlations - linalg::product(self.active.gram.as_ref(), mu.as_ref());
        self.active.sigma = linalg::gram(factor.as_ref());
        self.active.mu = mu.transpose().to_owned();
        self.misfit = misfit;
        self.log_determinant = log_determinant;
        self.stale = 0;
        Ok(())
    }

    /// Starts with these columns active, at these precisions and the noise that goes with them.
    pub(crate) fn resume(mut self, columns: &[usize], alpha: &[f64]) -> Result<Self> {
        self.active.replace(self.targets.gram, columns, alpha);
        self.refresh()?;
        self.update_noise();
        Ok(self)
    }

    /// The same without some of the active columns, at the same noise.
    fn without(&self, columns: &[usize]) -> Result<Self> {
        let mut others = self.clone();
        let (active, alpha) = self.active();
        let stay = active.iter().zip(alpha).filter(|(column, _)| !columns.contains(column));
        let (active, alpha): (Vec<_>, Vec<_>) = stay.unzip();
        others.active.replace(self.targets.gram, &active, &alpha);
        others.refresh()?;
        Ok(others)
    }

    /// The active columns and their precisions.
    pub(crate) fn active(&self) -> (&[usize], &[f64]) {
        (&self.active.columns, &self.active.alpha)
    }

    /// Log evidence of all targets together, nats.
    pub(crate) fn value(&self) -> f64 {
        let normal: f64 = self
            .misfit
            .iter()
            .zip(&self.noise)
            .map(|(misfit, noise)| {
                self.targets.freedom * (std::f64::consts::TAU * noise).ln() + misfit / noise
            })
            .sum();
        -0.5 * (normal + self.outputs() * self.log_determinant)
    }

    /// The objective: the evidence less `min_evidence_gain` for each active column.
    fn objective(&self) -> f64 {
        self.value() - self.min_evidence_gain * self.active.len() as f64
    }

    /// Noise variance of each target.
    pub(crate) fn noise(&self) -> &[f64] {
        &self.noise
    }

    /// Active columns; their mean weights, columns×m; and M with Σ = MᵀM.
    pub(crate) fn into_posterior(self) -> Result<(Vec<usize>, Mat<f64>, Mat<f64>)> {
        let Posterior { factor, mu, .. } = self.posterior()?;
        Ok((self.active.columns, mu, factor))
    }

    fn outputs(&self) -> f64 {
        self.noise.len() as f64
    }
}
