//! The evidence of one target and the rank-one steps that raise it.

use faer::{Mat, MatRef};

use crate::{Error, Result, linalg};

/// A column with less than this share of its energy outside the active ones depends on them, and
/// is neither added nor re-estimated: its α could be anything.
const DEPENDENT: f64 = 1e-10;

/// One standardised target, seen through the Gram matrix.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    /// G = ΦᵀΦ, p×p.
    pub(super) gram: MatRef<'a, f64>,
    /// Φᵀy, length p.
    pub(super) correlations: &'a [f64],
    /// yᵀy.
    pub(super) energy: f64,
    /// Samples less one for the bias.
    pub(super) freedom: f64,
}

/// A change of one column's precision α.
pub(super) struct Step {
    column: usize,
    /// The new precision; infinite to delete the column.
    alpha: f64,
    /// Nats gained.
    pub(super) gain: f64,
}

/// State of Tipping and Faul's algorithm for one target, with their symbols: active columns with
/// precisions α, posterior mean μ and covariance Σ of their weights, and for every column of the
/// dictionary the sparsity S and quality Q with respect to the present model.
pub(super) struct Evidence<'a> {
    target: Target<'a>,
    /// Noise precision 1/σ².
    beta: f64,
    active: Vec<usize>,
    /// Where a column stands among the active ones.
    position: Vec<Option<usize>>,
    alpha: Vec<f64>,
    mu: Vec<f64>,
    /// Σ, row by row.
    sigma: Vec<Vec<f64>>,
    sparsity: Vec<f64>,
    quality: Vec<f64>,
    /// Log evidence, in nats.
    value: f64,
}

/// The posterior over the active columns for given precisions, computed from scratch.
struct Posterior {
    /// M with Σ = MᵀM, lower triangular.
    factor: Mat<f64>,
    mu: Vec<f64>,
    value: f64,
}

impl<'a> Evidence<'a> {
    /// Starts with no column active.
    pub(super) fn new(target: Target<'a>, noise: f64) -> Result<Self> {
        let p = target.correlations.len();
        let mut evidence = Self {
            target,
            beta: noise.recip(),
            active: Vec::new(),
            position: vec![None; p],
            alpha: Vec::new(),
            mu: Vec::new(),
            sigma: Vec::new(),
            sparsity: vec![0.0; p],
            quality: vec![0.0; p],
            value: 0.0,
        };
        let posterior = evidence.posterior(evidence.beta)?;
        evidence.install(posterior);
        Ok(evidence)
    }

    pub(super) fn active(&self) -> &[usize] {
        &self.active
    }

    pub(super) fn value(&self) -> f64 {
        self.value
    }

    /// Noise variance σ².
    pub(super) fn noise(&self) -> f64 {
        self.beta.recip()
    }

    /// Active columns, their mean weights, and M with Σ = MᵀM.
    pub(super) fn into_posterior(self) -> Result<(Vec<usize>, Vec<f64>, Mat<f64>)> {
        let posterior = self.posterior(self.beta)?;
        Ok((self.active, posterior.mu, posterior.factor))
    }

    /// The step that raises the evidence the most.
    pub(super) fn best_step(&self) -> Step {
        let none = Step { column: 0, alpha: f64::INFINITY, gain: 0.0 };
        (0..self.position.len())
            .map(|column| self.step(column))
            .fold(none, |best, step| if step.gain > best.gain { step } else { best })
    }

    /// s and q of a column, the sparsity and quality measured without it, and its precision now.
    fn measures(&self, column: usize) -> (f64, f64, f64) {
        match self.position[column] {
            Some(i) => {
                let (variance, alpha) = (self.sigma[i][i], self.alpha[i]);
                ((variance.recip() - alpha).max(0.0), self.mu[i] / variance, alpha)
            }
            None => (self.sparsity[column], self.quality[column], f64::INFINITY),
        }
    }

    /// The best change of one column: the evidence is greatest at α = s²/(q² − s), or without the
    /// column if q² ≤ s.
    fn step(&self, column: usize) -> Step {
        let (s, q, now) = self.measures(column);
        let energy = self.beta * self.target.gram[(column, column)];
        let theta = q * q - s;
        let apart = s > DEPENDENT * energy;
        let alpha = if apart && theta > 0.0 { s * s / theta } else { f64::INFINITY };
        Step { column, alpha, gain: contribution(alpha, s, q) - contribution(now, s, q) }
    }

    /// Takes a step.
    pub(super) fn take(&mut self, step: &Step) {
        self.value += step.gain;
        match self.position[step.column] {
            None => self.add(step.column, step.alpha),
            Some(i) if step.alpha.is_infinite() => {
                let kappa = self.sigma[i][i].recip();
                self.shrink(i, kappa);
                self.remove(i);
            }
            Some(i) => {
                let kappa = (self.sigma[i][i] + (step.alpha - self.alpha[i]).recip()).recip();
                self.shrink(i, kappa);
                self.alpha[i] = step.alpha;
            }
        }
    }

    fn add(&mut self, column: usize, alpha: f64) {
        let variance = (alpha + self.sparsity[column]).recip();
        let mean = variance * self.quality[column];
        let gram = self.target.gram;
        // The active columns' regression on the new one: e = βΣΦᵀφ.
        let overlap: Vec<f64> =
            self.active.iter().map(|&k| self.beta * gram[(k, column)]).collect();
        let regression: Vec<f64> = self.sigma.iter().map(|row| dot(row, &overlap)).collect();
        let mut outside: Vec<f64> = gram.col(column).iter().map(|g| self.beta * g).collect();
        self.subtract_active(&mut outside, &regression);
        for (row, &e) in self.sigma.iter_mut().zip(&regression) {
            linalg::axpy(row, variance * e, &regression);
            row.push(-variance * e);
        }
        let mut last: Vec<f64> = regression.iter().map(|e| -variance * e).collect();
        last.push(variance);
        self.sigma.push(last);
        linalg::axpy(&mut self.mu, -mean, &regression);
        self.mu.push(mean);
        for ((s, q), c) in self.sparsity.iter_mut().zip(&mut self.quality).zip(&outside) {
            *s -= variance * c * c;
            *q -= mean * c;
        }
        self.position[column] = Some(self.active.len());
        self.active.push(column);
        self.alpha.push(alpha);
    }

    /// Σ ← Σ − κ Σᵢ Σᵢᵀ and what follows from it: a re-estimate, or (κ = 1/Σᵢᵢ) a deletion.
    fn shrink(&mut self, i: usize, kappa: f64) {
        let direction = self.sigma[i].clone();
        let mean = self.mu[i];
        let mut overlap = vec![0.0; self.position.len()];
        self.subtract_active(&mut overlap, &direction);
        for (row, d) in self.sigma.iter_mut().zip(&direction) {
            linalg::axpy(row, -kappa * d, &direction);
        }
        linalg::axpy(&mut self.mu, -kappa * mean, &direction);
        for ((s, q), c) in self.sparsity.iter_mut().zip(&mut self.quality).zip(&overlap) {
            *s += kappa * c * c;
            *q -= kappa * mean * c;
        }
    }

    /// `values` −= β Φᵀ Φ_active `coefficients`.
    fn subtract_active(&self, values: &mut [f64], coefficients: &[f64]) {
        for (&k, coefficient) in self.active.iter().zip(coefficients) {
            let column = self.target.gram.col(k);
            let scale = self.beta * coefficient;
            values.iter_mut().zip(column.iter()).for_each(|(v, g)| *v -= scale * g);
        }
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

    /// Re-estimates the noise variance, at least `floor`, without lowering the evidence; returns
    /// by how much its logarithm moved.
    pub(super) fn update_noise(&mut self, floor: f64) -> Result<f64> {
        let before = self.posterior(self.beta)?;
        let gram = self.target.gram;
        let determined: f64 =
            self.alpha.iter().enumerate().map(|(i, a)| 1.0 - a * self.sigma[i][i]).sum();
        let weights = &before.mu;
        let mut error = self.target.energy;
        for (&k, w) in self.active.iter().zip(weights) {
            let fitted: f64 = self.active.iter().zip(weights).map(|(&l, v)| gram[(l, k)] * v).sum();
            error += w * (fitted - 2.0 * self.target.correlations[k]);
        }
        let error = error.max(0.0);
        let freedom = self.target.freedom;
        let mackay = error / (freedom - determined).max(1.0);
        let em = (error + self.noise() * determined) / freedom;
        let old = self.beta;
        for noise in [mackay, em] {
            let beta = noise.max(floor).recip();
            let posterior = self.posterior(beta)?;
            if posterior.value >= before.value {
                self.beta = beta;
                self.install(posterior);
                return Ok((beta / old).ln().abs());
            }
        }
        self.install(before);
        Ok(0.0)
    }

    /// The posterior over the active columns at noise precision `beta`.
    fn posterior(&self, beta: f64) -> Result<Posterior> {
        let (gram, active) = (self.target.gram, &self.active);
        let size = active.len();
        let d: Vec<f64> = self.alpha.iter().map(|a| a.sqrt().recip()).collect();
        let system = Mat::from_fn(size, size, |i, j| {
            let unit = if i == j { 1.0 } else { 0.0 };
            beta * d[i] * gram[(active[i], active[j])] * d[j] + unit
        });
        let cholesky = linalg::cholesky(system).ok_or(Error::Singular { size })?;
        let mut factor = linalg::lower_inverse(cholesky.as_ref());
        for (j, d) in d.iter().enumerate() {
            factor.col_as_slice_mut(j).iter_mut().for_each(|v| *v *= d);
        }
        let correlations = Mat::from_fn(size, 1, |i, _| beta * self.target.correlations[active[i]]);
        let half = linalg::product(factor.as_ref(), correlations.as_ref());
        let mu = linalg::product(factor.transpose(), half.as_ref()).col_as_slice(0).to_vec();
        let log_determinant: f64 = (0..size).map(|i| 2.0 * cholesky[(i, i)].ln()).sum();
        let misfit = beta * self.target.energy - half.squared_norm_l2();
        let normal = self.target.freedom * ((2.0 * std::f64::consts::PI).ln() - beta.ln());
        let value = -0.5 * (normal + log_determinant + misfit);
        Ok(Posterior { factor, mu, value })
    }

    /// Takes over a posterior and recomputes S and Q from it.
    fn install(&mut self, posterior: Posterior) {
        let Target { gram, correlations, .. } = self.target;
        let Posterior { factor, mu, value } = posterior;
        let rows = Mat::from_fn(self.active.len(), gram.ncols(), |i, k| gram[(k, self.active[i])]);
        let overlap = linalg::product(factor.as_ref(), rows.as_ref());
        let fitted =
            linalg::product(rows.transpose(), MatRef::from_column_major_slice(&mu, mu.len(), 1));
        for k in 0..gram.ncols() {
            let explained = self.beta * self.beta * overlap.col(k).squared_norm_l2();
            self.sparsity[k] = self.beta * gram[(k, k)] - explained;
            self.quality[k] = self.beta * (correlations[k] - fitted[(k, 0)]);
        }
        let sigma = linalg::gram(factor.as_ref());
        self.sigma = (0..mu.len()).map(|i| sigma.col_as_slice(i).to_vec()).collect();
        self.mu = mu;
        self.value = value;
    }
}

/// ℓ(α), what a column with precision α adds to the log evidence; nothing if α is infinite.
fn contribution(alpha: f64, s: f64, q: f64) -> f64 {
    if alpha.is_infinite() {
        return 0.0;
    }
    0.5 * (q * q / (alpha + s) - (s / alpha).ln_1p())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use faer::linalg::solvers::Solve;
    use rand_core::Rng;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    /// S, Q and the log evidence from C = σ²I + ΦA⁻¹Φᵀ itself.
    fn directly(
        evidence: &Evidence<'_>,
        phi: MatRef<'_, f64>,
        y: MatRef<'_, f64>,
    ) -> (Vec<f64>, Vec<f64>, f64) {
        let n = phi.nrows();
        let mut c = evidence.noise() * Mat::<f64>::identity(n, n);
        for (&k, alpha) in evidence.active.iter().zip(&evidence.alpha) {
            c += phi.col(k) * phi.col(k).transpose() / faer::Scale(*alpha);
        }
        let lu = c.full_piv_lu();
        let (by_phi, by_y) = (lu.solve(phi), lu.solve(y));
        let sparsity = (0..phi.ncols()).map(|k| phi.col(k).transpose() * by_phi.col(k)).collect();
        let quality = (0..phi.ncols()).map(|k| phi.col(k).transpose() * by_y.col(0)).collect();
        // Centred data lie in n − 1 dimensions; the mean's direction has variance σ².
        let log_determinant = c.determinant().ln() - evidence.noise().ln();
        let normal = (n as f64 - 1.0) * (2.0 * std::f64::consts::PI).ln();
        let misfit = y.col(0).transpose() * by_y.col(0);
        (sparsity, quality, -0.5 * (normal + log_determinant + misfit))
    }

    #[test]
    fn every_step_keeps_what_a_full_recomputation_gives() {
        let mut random = Pcg64Mcg::new(77);
        let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
        let (n, p) = (25, 12);
        let raw = Mat::from_fn(n, p, |_, _| uniform());
        let phi = Mat::from_fn(n, p, |i, k| raw[(i, k)] - raw.col(k).sum() / n as f64);
        let signal = Mat::from_fn(n, 1, |i, _| {
            (0..p).map(|k| phi[(i, k)] * k as f64 / 6.0).sum::<f64>() + uniform()
        });
        let y = Mat::from_fn(n, 1, |i, _| signal[(i, 0)] - signal.col(0).sum() / n as f64);
        let gram = linalg::gram(phi.as_ref());
        let correlations = linalg::product(phi.transpose(), y.as_ref());
        let target = Target {
            gram: gram.as_ref(),
            correlations: correlations.col_as_slice(0),
            energy: y.squared_norm_l2(),
            freedom: n as f64 - 1.0,
        };
        let mut evidence = Evidence::new(target, 0.2).unwrap();
        let close = |a: f64, b: f64| (a - b).abs() < 1e-8 * (1.0 + b.abs());
        let (mut added, mut changed, mut deleted) = (0, 0, 0);
        for round in 0..90 {
            // Any step will do, not only the best: here a column at a time, at varying precisions.
            let column = round * 5 % p;
            let place = evidence.position[column];
            let delete = place.is_some() && round % 3 == 0;
            let alpha = if delete { f64::INFINITY } else { 0.1 + f64::from(round as u32 * 7 % 11) };
            let (s, q, now) = evidence.measures(column);
            let gain = contribution(alpha, s, q) - contribution(now, s, q);
            evidence.take(&Step { column, alpha, gain });
            match (place, delete) {
                (None, _) => added += 1,
                (Some(_), false) => changed += 1,
                (Some(_), true) => deleted += 1,
            }
            if round % 20 == 19 {
                evidence.update_noise(1e-4).unwrap();
            }
            let (sparsity, quality, value) = directly(&evidence, phi.as_ref(), y.as_ref());
            assert!(close(evidence.value, value), "{} {value}", evidence.value);
            for k in 0..p {
                assert!(close(evidence.sparsity[k], sparsity[k]));
                assert!(close(evidence.quality[k], quality[k]));
            }
            let posterior = evidence.posterior(evidence.beta).unwrap();
            assert!(evidence.mu.iter().zip(&posterior.mu).all(|(a, b)| close(*a, *b)));
            let sigma = linalg::gram(posterior.factor.as_ref());
            for (i, row) in evidence.sigma.iter().enumerate() {
                assert!(row.iter().zip(sigma.col_as_slice(i)).all(|(a, b)| close(*a, *b)));
            }
        }
        assert!(added > 10 && changed > 10 && deleted > 10, "{added} {changed} {deleted}");
    }
}
