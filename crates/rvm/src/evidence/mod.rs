//! The evidence of targets that share their relevant columns, and the rank-one steps that raise it.

mod ascent;
mod posterior;
#[cfg(test)]
mod tests;

use faer::{Mat, MatRef};

pub(crate) use ascent::Ascent;
use posterior::Posterior;

use crate::{Result, linalg};

/// A column with less than this share of its energy outside the active ones depends on them, and
/// is neither added nor re-estimated: its α could be anything.
const DEPENDENT: f64 = 1e-10;
/// First guess of the noise, as a share of a target's variance.
const FIRST_NOISE: f64 = 0.1;

/// Standardised targets, none of them constant, seen through the normal equations.
#[derive(Clone, Copy)]
pub(crate) struct Targets<'a> {
    /// G = ΦᵀΦ, p×p.
    pub(crate) gram: &'a Mat<f64>,
    /// ΦᵀY, p×m.
    pub(crate) correlations: MatRef<'a, f64>,
    /// ‖yⱼ‖² of each of the m targets.
    pub(crate) energies: &'a [f64],
    /// Samples less one for the bias.
    pub(crate) freedom: f64,
}

/// A change of one hyper-parameter, the others held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Change {
    /// The column's precision α; infinite to delete it.
    Precision { column: usize, alpha: f64 },
    /// Every target's noise, to where the evidence is greatest.
    Noise,
}

/// A change and what it is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step {
    change: Change,
    /// What the objective gains, nats.
    gain: f64,
}

/// State of Tipping and Faul's (2003) algorithm for targets that share their precisions, with
/// their symbols.
///
/// The weights' prior is relative to the noise: wᵢⱼ ~ N(0, σⱼ²/αᵢ), as in Ha and Zhang (2017).
/// Then target j is distributed as N(0, σⱼ²C) with one C = I + ΦA⁻¹Φᵀ, and the targets share Σ
/// and S while the noise stands apart from both: a new σⱼ² changes neither. For one target this is
/// Tipping and Faul's own model with α/σ² written for α.
#[derive(Clone)]
pub(crate) struct Evidence<'a> {
    targets: Targets<'a>,
    /// Least noise variance.
    floor: f64,
    /// Most active columns.
    most: usize,
    /// Nats that each active column must add to the evidence.
    price: f64,
    /// Noise variance σⱼ².
    noise: Vec<f64>,
    active: Vec<usize>,
    /// Where a column stands among the active ones.
    position: Vec<Option<usize>>,
    alpha: Vec<f64>,
    /// Posterior mean of the active columns' weights, m numbers for each column.
    mu: Vec<Vec<f64>>,
    /// Σ, their posterior covariance over σⱼ², row by row.
    sigma: Vec<Vec<f64>>,
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

impl<'a> Evidence<'a> {
    /// Starts with no column active.
    pub(crate) fn new(targets: Targets<'a>, floor: f64, most: usize, price: f64) -> Result<Self> {
        let (p, m) = targets.correlations.shape();
        let mut evidence = Self {
            targets,
            floor,
            most,
            price,
            noise: vec![1.0; m],
            active: Vec::new(),
            position: vec![None; p],
            alpha: Vec::new(),
            mu: Vec::new(),
            sigma: Vec::new(),
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

    /// Starts with these columns active, at these precisions and the noise that goes with them.
    pub(crate) fn resume(mut self, active: &[usize], alpha: &[f64]) -> Result<Self> {
        self.active = active.to_vec();
        self.alpha = alpha.to_vec();
        for (i, &column) in active.iter().enumerate() {
            self.position[column] = Some(i);
        }
        self.refresh()?;
        self.update_noise();
        Ok(self)
    }

    /// The active columns and their precisions.
    pub(crate) fn active(&self) -> (&[usize], &[f64]) {
        (&self.active, &self.alpha)
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

    /// What is climbed: the evidence less the price of the active columns.
    fn objective(&self) -> f64 {
        self.value() - self.price * self.active.len() as f64
    }

    /// Noise variance of each target.
    pub(crate) fn noise(&self) -> &[f64] {
        &self.noise
    }

    /// Active columns; their mean weights, columns×m; and M with Σ = MᵀM.
    pub(crate) fn into_posterior(self) -> Result<(Vec<usize>, Mat<f64>, Mat<f64>)> {
        let Posterior { factor, mu, .. } = self.posterior()?;
        Ok((self.active, mu, factor))
    }

    fn outputs(&self) -> f64 {
        self.noise.len() as f64
    }

    /// The step that raises the objective the most.
    fn best_step(&self) -> Step {
        let qualities = self.qualities();
        let noise = Step { change: Change::Noise, gain: self.noise_gain() };
        let steps = self.active.iter().map(|&k| self.step(k, qualities[k]));
        let addition = self.likeliest(&qualities).map(|k| self.step(k, qualities[k]));
        steps
            .chain(addition)
            .fold(noise, |best, step| if step.gain > best.gain { step } else { best })
    }

    /// The column that gains the most of those that could be added: what it gains rises with its
    /// quality over its sparsity.
    fn likeliest(&self, qualities: &[f64]) -> Option<usize> {
        let ratio = |k: usize| match self.position[k] {
            None if self.apart(k, self.sparsity[k]) => qualities[k] / self.sparsity[k],
            _ => 0.0,
        };
        let start = (None, self.outputs());
        let (best, _) = (0..qualities.len()).fold(start, |(best, highest), k| {
            let ratio = ratio(k);
            if ratio > highest { (Some(k), ratio) } else { (best, highest) }
        });
        best
    }

    /// What the evidence gains if every target's noise becomes the best.
    fn noise_gain(&self) -> f64 {
        let gains = self.misfit.iter().zip(&self.noise).map(|(misfit, noise)| {
            let excess = |noise: f64| self.targets.freedom * noise.ln() + misfit / noise;
            0.5 * (excess(*noise) - excess(self.best_noise(*misfit)))
        });
        gains.sum()
    }

    fn best_noise(&self, misfit: f64) -> f64 {
        (misfit / self.targets.freedom).max(self.floor)
    }

    /// Σⱼ qⱼ²/σⱼ² of every column, measured without the column itself.
    fn qualities(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.position.len()];
        for (j, noise) in self.noise.iter().enumerate() {
            let (quality, precision) = (self.quality.col_as_slice(j), noise.recip());
            sums.iter_mut().zip(quality).for_each(|(sum, q)| *sum += precision * q * q);
        }
        for &column in &self.active {
            let of_targets = self.quality_of(column);
            sums[column] = of_targets.iter().zip(&self.noise).map(|(q, noise)| q * q / noise).sum();
        }
        sums
    }

    /// qⱼ of one column for each target, measured without the column itself.
    fn quality_of(&self, column: usize) -> Vec<f64> {
        match self.position[column] {
            Some(i) => self.mu[i].iter().map(|mu| mu / self.sigma[i][i]).collect(),
            None => self.quality.row(column).iter().copied().collect(),
        }
    }

    /// s of one column, measured without the column itself.
    fn sparsity_of(&self, column: usize) -> f64 {
        match self.position[column] {
            Some(i) => (self.sigma[i][i].recip() - self.alpha[i]).max(0.0),
            None => self.sparsity[column],
        }
    }

    /// The precision of a column; infinite if it is not active.
    fn alpha_of(&self, column: usize) -> f64 {
        self.position[column].map_or(f64::INFINITY, |i| self.alpha[i])
    }

    /// Is enough of a column, whose s this is, outside the active ones?
    fn apart(&self, column: usize, s: f64) -> bool {
        s > DEPENDENT * self.targets.gram[(column, column)]
    }

    /// The best change of one column: the evidence is greatest at α = m s²/(Σⱼ qⱼ²/σⱼ² − m s), or
    /// without the column if that is negative or not worth the column's price.
    fn step(&self, column: usize, quality: f64) -> Step {
        let (s, now, m) = (self.sparsity_of(column), self.alpha_of(column), self.outputs());
        let room = now.is_finite() || self.active.len() < self.most;
        let theta = quality - m * s;
        // ℓ(α), what the column adds to the log evidence, less its price.
        let adds = |alpha: f64| {
            if alpha.is_infinite() {
                return 0.0;
            }
            0.5 * (quality / (alpha + s) - m * (s / alpha).ln_1p()) - self.price
        };
        let best = if theta > 0.0 { m * s * s / theta } else { f64::INFINITY };
        let keep = self.apart(column, s) && room && adds(best) > 0.0;
        let alpha = if keep { best } else { f64::INFINITY };
        Step { change: Change::Precision { column, alpha }, gain: adds(alpha) - adds(now) }
    }

    fn take(&mut self, change: Change) {
        match change {
            Change::Noise => self.update_noise(),
            Change::Precision { column, alpha } => self.set_precision(column, alpha),
        }
        self.stale += 1;
    }

    fn set_precision(&mut self, column: usize, alpha: f64) {
        let (s, now) = (self.sparsity_of(column), self.alpha_of(column));
        let explained = (now + s).recip() - (alpha + s).recip();
        let qualities = self.quality_of(column);
        for (misfit, q) in self.misfit.iter_mut().zip(qualities) {
            *misfit += q * q * explained;
        }
        self.log_determinant += (s / alpha).ln_1p() - (s / now).ln_1p();
        match self.position[column] {
            None => self.add(column, alpha),
            Some(i) if alpha.is_infinite() => {
                self.shrink(i, self.sigma[i][i].recip());
                self.remove(i);
            }
            Some(i) => {
                self.shrink(i, (self.sigma[i][i] + (alpha - now).recip()).recip());
                self.alpha[i] = alpha;
            }
        }
    }

    fn update_noise(&mut self) {
        for j in 0..self.noise.len() {
            self.noise[j] = self.best_noise(self.misfit[j]);
        }
    }

    fn add(&mut self, column: usize, alpha: f64) {
        let gram = self.targets.gram;
        let variance = (alpha + self.sparsity[column]).recip();
        let mean: Vec<f64> = self.quality.row(column).iter().map(|q| variance * q).collect();
        // The active columns' regression on the new one: e = ΣΦᵀφ.
        let mut regression = vec![0.0; self.active.len()];
        for (&k, row) in self.active.iter().zip(&self.sigma) {
            linalg::axpy(&mut regression, gram[(k, column)], row);
        }
        let mut outside = gram.col_as_slice(column).to_vec();
        self.subtract_active(&mut outside, &regression);
        for ((row, mu), &e) in self.sigma.iter_mut().zip(&mut self.mu).zip(&regression) {
            linalg::axpy(row, variance * e, &regression);
            row.push(-variance * e);
            linalg::axpy(mu, -e, &mean);
        }
        let mut last: Vec<f64> = regression.iter().map(|e| -variance * e).collect();
        last.push(variance);
        self.sigma.push(last);
        self.explain(&outside, variance, &mean);
        self.mu.push(mean);
        self.position[column] = Some(self.active.len());
        self.active.push(column);
        self.alpha.push(alpha);
    }

    /// Σ ← Σ − κ Σᵢ Σᵢᵀ and what follows from it: a re-estimate, or (κ = 1/Σᵢᵢ) a deletion.
    fn shrink(&mut self, i: usize, kappa: f64) {
        let direction = self.sigma[i].clone();
        let change: Vec<f64> = self.mu[i].iter().map(|mu| kappa * mu).collect();
        let mut overlap = vec![0.0; self.position.len()];
        self.subtract_active(&mut overlap, &direction);
        for ((row, mu), &d) in self.sigma.iter_mut().zip(&mut self.mu).zip(&direction) {
            linalg::axpy(row, -kappa * d, &direction);
            linalg::axpy(mu, -d, &change);
        }
        self.explain(&overlap, -kappa, &change);
    }

    /// S −= `variance` c², Qⱼ −= `mean`ⱼ c.
    fn explain(&mut self, c: &[f64], variance: f64, mean: &[f64]) {
        self.sparsity.iter_mut().zip(c).for_each(|(s, c)| *s -= variance * c * c);
        for (j, mean) in mean.iter().enumerate() {
            linalg::axpy(self.quality.col_as_slice_mut(j), -mean, c);
        }
    }

    /// `values` −= Φᵀ Φ_active `coefficients`.
    fn subtract_active(&self, values: &mut [f64], coefficients: &[f64]) {
        let columns: Vec<&[f64]> =
            self.active.iter().map(|&k| self.targets.gram.col_as_slice(k)).collect();
        linalg::subtract_products(values, coefficients, &columns);
    }

    fn remove(&mut self, i: usize) {
        self.position[self.active[i]] = None;
        self.active.swap_remove(i);
        self.alpha.swap_remove(i);
        self.mu.swap_remove(i);
        self.sigma.swap_remove(i);
        for row in &mut self.sigma {
            row.swap_remove(i);
        }
        if let Some(&moved) = self.active.get(i) {
            self.position[moved] = Some(i);
        }
    }
}
