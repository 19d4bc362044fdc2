//! One change of one hyper-parameter: what it gains, and how it is made.

use crate::linalg;
use crate::rvm::marginal_likelihood::MarginalLikelihood;
use crate::rvm::marginal_likelihood::active::New;

/// A column with less than this share of its energy outside the active ones depends on them, and
/// is neither added nor re-estimated: its α could be anything.
const DEPENDENT: f64 = 1e-10;

/// A change of one hyper-parameter, the others held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Change {
    /// The column's precision α; infinite to delete it.
    Precision { column: usize, alpha: f64 },
    /// Every target's noise, to where the evidence is greatest.
    Noise,
}

/// A change and what it is worth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    pub(super) change: Change,
    /// What the objective gains, nats.
    pub(super) gain: f64,
}

/// What a column adds to the evidence depends on this of it, measured without the column itself.
#[derive(Clone, Copy)]
struct Worth {
    /// Sparsity s.
    s: f64,
    /// Σⱼ qⱼ²/σⱼ².
    quality: f64,
    /// Its precision; infinite if it is not active.
    alpha: f64,
}

impl MarginalLikelihood<'_> {
    /// The step that raises the objective the most.
    pub(super) fn best_step(&self) -> Step {
        let noise = Step { change: Change::Noise, gain: self.noise_gain() };
        let active = (0..self.active.len()).map(|i| self.step_of_active(i));
        active
            .chain(self.best_addition())
            .fold(noise, |best, step| if step.gain > best.gain { step } else { best })
    }

    /// The addition that gains the most: what one gains rises with its quality over its sparsity.
    fn best_addition(&self) -> Option<Step> {
        if self.active.len() >= self.most {
            return None;
        }
        let qualities = self.qualities();
        let ratio = |k: usize| match self.active.position(k) {
            None if self.apart(k, self.sparsity[k]) => qualities[k] / self.sparsity[k],
            _ => 0.0,
        };
        let start = (None, self.outputs());
        let (best, _) = (0..qualities.len()).fold(start, |(best, highest), k| {
            let ratio = ratio(k);
            if ratio > highest { (Some(k), ratio) } else { (best, highest) }
        });
        let column = best?;
        let (s, quality) = (self.sparsity[column], qualities[column]);
        Some(self.step(column, Worth { s, quality, alpha: f64::INFINITY }))
    }

    /// Σⱼ Qⱼ²/σⱼ² of every column.
    fn qualities(&self) -> Vec<f64> {
        let mut sums = vec![0.0; self.sparsity.len()];
        for (j, noise) in self.noise.iter().enumerate() {
            let (quality, precision) = (self.quality.col_as_slice(j), noise.recip());
            sums.iter_mut().zip(quality).for_each(|(sum, q)| *sum += precision * q * q);
        }
        sums
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

    /// Is enough of a column, whose s this is, outside the active ones?
    fn apart(&self, column: usize, s: f64) -> bool {
        s > DEPENDENT * self.targets.gram[(column, column)]
    }

    fn step_of_active(&self, i: usize) -> Step {
        let variance = self.active.sigma[(i, i)];
        let of_targets = self.active.mu.col(i).iter().zip(&self.noise);
        let quality: f64 = of_targets.map(|(mu, noise)| mu * mu / noise).sum();
        let worth = Worth {
            s: self.sparsity_of_active(i),
            quality: quality / (variance * variance),
            alpha: self.active.alpha[i],
        };
        self.step(self.active.columns[i], worth)
    }

    /// s of an active column, measured without the column itself.
    fn sparsity_of_active(&self, i: usize) -> f64 {
        (self.active.sigma[(i, i)].recip() - self.active.alpha[i]).max(0.0)
    }

    /// The best change of one column: the evidence is greatest at α = m s²/(Σⱼ qⱼ²/σⱼ² − m s), or
    /// without the column if that is negative or gains less than `min_evidence_gain`.
    fn step(&self, column: usize, worth: Worth) -> Step {
        let (Worth { s, quality, alpha: now }, m) = (worth, self.outputs());
        let theta = quality - m * s;
        // ℓ(α), what the column adds to the log evidence, less `min_evidence_gain`.
        let adds = |alpha: f64| {
            if alpha.is_infinite() {
                return 0.0;
            }
            0.5 * (quality / (alpha + s) - m * (s / alpha).ln_1p()) - self.min_evidence_gain
        };
        let best = if theta > 0.0 { m * s * s / theta } else { f64::INFINITY };
        let keep = self.apart(column, s) && adds(best) > 0.0;
        let alpha = if keep { best } else { f64::INFINITY };
        Step { change: Change::Precision { column, alpha }, gain: adds(alpha) - adds(now) }
    }

    pub(super) fn take(&mut self, change: Change) {
        match change {
            Change::Noise => self.update_noise(),
            Change::Precision { column, alpha } => match self.active.position(column) {
                Some(i) => self.change(i, alpha),
                None => self.add(column, alpha),
            },
        }
        self.stale += 1;
    }

    pub(super) fn update_noise(&mut self) {
        for j in 0..self.noise.len() {
            self.noise[j] = self.best_noise(self.misfit[j]);
        }
    }

    fn add(&mut self, column: usize, alpha: f64) {
        let s = self.sparsity[column];
        let variance = (alpha + s).recip();
        let mean: Vec<f64> = self.quality.row(column).iter().map(|q| variance * q).collect();
        for (misfit, q) in self.misfit.iter_mut().zip(self.quality.row(column).iter()) {
            *misfit -= q * q * variance;
        }
        self.log_determinant += (s / alpha).ln_1p();
        let gram = self.targets.gram.col_as_slice(column);
        // The active columns' regression on the new one: e = ΣΦᵀφ.
        let products: Vec<f64> = self.active.columns.iter().map(|&k| gram[k]).collect();
        let regression = linalg::times(self.active.sigma.as_ref(), &products);
        let mut direction: Vec<f64> = regression.iter().map(|e| -e).collect();
        direction.push(1.0);
        self.active.push(&New {
            column,
            alpha,
            gram,
            regression: &regression,
            variance,
            mean: &mean,
        });
        self.explain(&direction, variance, &mean);
    }

    /// Changes the precision of an active column, or deletes it (κ = 1/Σᵢᵢ):
    /// Σ ← Σ − κ Σᵢ Σᵢᵀ and what follows from it.
    fn change(&mut self, i: usize, alpha: f64) {
        let (s, now) = (self.sparsity_of_active(i), self.active.alpha[i]);
        let variance = self.active.sigma[(i, i)];
        let explained = (now + s).recip() - (alpha + s).recip();
        for (misfit, mu) in self.misfit.iter_mut().zip(self.active.mu.col(i).iter()) {
            *misfit += (mu / variance).powi(2) * explained;
        }
        self.log_determinant += (s / alpha).ln_1p() - (s / now).ln_1p();
        let deleted = alpha.is_infinite();
        let kappa =
            if deleted { variance.recip() } else { (variance + (alpha - now).recip()).recip() };
        let direction = self.active.sigma.col_as_slice(i).to_vec();
        let mean: Vec<f64> = self.active.mu.col(i).iter().map(|mu| -kappa * mu).collect();
        self.active.add_to_sigma(-kappa, &direction);
        self.active.add_to_mu(&mean, &direction);
        self.explain(&direction, -kappa, &mean);
        if deleted {
            self.active.swap_remove(i);
        } else {
            self.active.alpha[i] = alpha;
        }
    }
    /// With c = Φᵀ Φ_active `direction`: S −= `variance` c², Qⱼ −= `mean`ⱼ c.
    fn explain(&mut self, direction: &[f64], variance: f64, mean: &[f64]) {
        let c = linalg::times(self.active.gram.as_ref(), direction);
        self.sparsity.iter_mut().zip(&c).for_each(|(s, c)| *s -= variance * c * c);
        for (j, mean) in mean.iter().enumerate() {
            linalg::axpy(self.quality.col_as_slice_mut(j), -mean, &c);
        }
    }
}
