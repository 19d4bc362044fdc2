//! The multivariate machine against a slow one that solves every candidate from scratch, and its
//! evidence, sparsity and sharing.

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef};
use phalanx_rvm::{
    Bandwidth, BasisSpec, Kernel, MultiOutputRvm, PilotSample, Regressor, RelevanceVectorMachine,
    StandardScaler, SufficientStatistics,
};
use proptest::prelude::*;

use crate::problems::{GAUSSIAN, Source, close, rows, smooth};
use crate::property;

/// The same climb with C = I + ΦA⁻¹Φᵀ formed and solved anew for every candidate of every step.
struct Slow {
    /// Centred columns, n×p, and centred targets, n×m.
    phi: Mat<f64>,
    y: Mat<f64>,
    alpha: Vec<f64>,
    noise: Vec<f64>,
}

impl Slow {
    fn new(x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> phalanx_rvm::Result<Self> {
        let phi = StandardScaler::fit(x)?.apply(x)?.transpose().to_owned();
        let y = StandardScaler::fit(y)?.apply(y)?.transpose().to_owned();
        let freedom = y.nrows() as f64 - 1.0;
        let noise = y.col_iter().map(|target| 0.1 * target.squared_norm_l2() / freedom).collect();
        let alpha = vec![f64::INFINITY; phi.ncols()];
        Ok(Self { phi, y, alpha, noise })
    }

    /// C with these precisions.
    fn covariance(&self, alpha: &[f64]) -> Mat<f64> {
        let n = self.phi.nrows();
        let mut c = Mat::<f64>::identity(n, n);
        for (k, alpha) in alpha.iter().enumerate().filter(|(_, alpha)| alpha.is_finite()) {
            let column = self.phi.col(k);
            c += column * column.transpose() / faer::Scale(*alpha);
        }
        c
    }

    /// yⱼᵀC⁻¹yⱼ of each target, and log |C|.
    fn misfits(&self, alpha: &[f64]) -> (Vec<f64>, f64) {
        let c = self.covariance(alpha);
        let solved = c.full_piv_lu().solve(&self.y);
        let misfit = |j| self.y.col(j).transpose() * solved.col(j);
        ((0..self.y.ncols()).map(misfit).collect(), c.determinant().ln())
    }

    fn evidence(&self, alpha: &[f64]) -> f64 {
        let (misfits, log_determinant) = self.misfits(alpha);
        let freedom = self.y.nrows() as f64 - 1.0;
        let of_target = |(misfit, noise): (&f64, &f64)| {
            let normal = freedom * (2.0 * std::f64::consts::PI * noise).ln();
            -0.5 * (normal + log_determinant + misfit / noise)
        };
        misfits.iter().zip(&self.noise).map(of_target).sum()
    }

    /// The best precision of one column with the others held.
    fn best_alpha(&self, k: usize) -> f64 {
        let mut without = self.alpha.clone();
        without[k] = f64::INFINITY;
        let lu = self.covariance(&without).full_piv_lu();
        let column = self.phi.col(k);
        let solved = lu.solve(column);
        let (s, m) = (column.transpose() * &solved, self.noise.len() as f64);
        let q = |j: usize| self.y.col(j).transpose() * &solved;
        let quality: f64 = (0..self.noise.len()).map(|j| q(j).powi(2) / self.noise[j]).sum();
        let theta = quality - m * s;
        if theta > 0.0 { m * s * s / theta } else { f64::INFINITY }
    }

    /// Takes the best step, of one precision or of all targets' noise; returns the evidence after
    /// it, or nothing if none gains.
    fn climb(&mut self, tolerance: f64) -> Option<f64> {
        let now = self.evidence(&self.alpha);
        let candidate = |k: usize| {
            let mut alpha = self.alpha.clone();
            alpha[k] = self.best_alpha(k);
            (self.evidence(&alpha) - now, alpha)
        };
        let (gain, alpha) =
            (0..self.alpha.len()).map(candidate).max_by(|a, b| a.0.total_cmp(&b.0))?;
        let freedom = self.y.nrows() as f64 - 1.0;
        let best = self.misfits(&self.alpha).0.iter().map(|misfit| misfit / freedom).collect();
        let held = std::mem::replace(&mut self.noise, best);
        let by_noise = self.evidence(&self.alpha) - now;
        if by_noise.max(gain) <= tolerance {
            return None;
        }
        if gain > by_noise {
            (self.alpha, self.noise) = (alpha, held);
        }
        Some(self.evidence(&self.alpha))
    }
}

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn it_climbs_as_the_slow_one_does(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 7, 3, 20);
        let mut slow = Slow::new(x.as_ref(), y.as_ref())?;
        let rvm =
            MultiOutputRvm { kernel: Kernel::Linear, min_evidence_gain: 0.0, ..MultiOutputRvm::default() };
        let fit = rvm.fit(x.as_ref(), y.as_ref())?;
        for &fast in &fit.report.traces[0].objective {
            let evidence = slow.climb(rvm.tolerance);
            let same = evidence.is_some_and(|e| (e - fast).abs() < 1e-6 * (1.0 + fast.abs()));
            prop_assert!(same, "{fast} {evidence:?}");
        }
        prop_assert!(slow.climb(rvm.tolerance * 1.001).is_none());
        let kept: Vec<usize> = (0..7).filter(|&k| slow.alpha[k].is_finite()).collect();
        prop_assert_eq!(fit.model.selected_features(), kept);
    }

    #[test]
    fn the_evidence_never_falls(seed in any::<u64>(), most in prop::option::of(1..10_usize)) {
        let (x, y) = smooth(seed, 5, 3, 60);
        let (price, restarts) = (0.0, 4);
        let rvm = MultiOutputRvm { kernel: GAUSSIAN, max_columns: most, min_evidence_gain: price, restarts, ..Default::default() };
        let fit = rvm.fit(x.as_ref(), y.as_ref())?;
        prop_assert!(fit.report.converged);
        prop_assert!(fit.model.kept_samples().len() <= most.unwrap_or(60));
        let evidence = &fit.report.traces[0].objective;
        let rises = evidence.is_sorted_by(|a, b| *b >= a - 1e-9 * a.abs().max(1.0));
        prop_assert!(rises, "{evidence:?}");
    }

    /// With one target there is nothing to share.
    #[test]
    fn of_one_target_it_is_tippings(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 4, 1, 40);
        let restarts = 3;
        let one = MultiOutputRvm { kernel: GAUSSIAN, restarts, ..MultiOutputRvm::default() };
        let tipping = RelevanceVectorMachine { kernel: GAUSSIAN, restarts, ..RelevanceVectorMachine::default() };
        let (one, tipping) = (one.fit(x.as_ref(), y.as_ref())?, tipping.fit(x.as_ref(), y.as_ref())?);
        prop_assert_eq!(one, tipping);
    }

    #[test]
    fn a_target_given_twice_changes_no_prediction(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 4, 2, 40);
        let twice = rows(y.as_ref(), &[0, 1, 0, 1]);
        let rvm = MultiOutputRvm { kernel: Kernel::Linear, ..MultiOutputRvm::default() };
        // Twice the evidence asks for twice the tolerance and the price.
        let (tolerance, price) = (2.0 * rvm.tolerance, 2.0 * rvm.min_evidence_gain);
        let doubled = MultiOutputRvm { tolerance, min_evidence_gain: price, ..rvm };
        let (mean, std) = rvm.fit(x.as_ref(), y.as_ref())?.model.predict_with_std(x.as_ref())?;
        let again = doubled.fit(x.as_ref(), twice.as_ref())?.model;
        let (mean_again, std_again) = again.predict_with_std(x.as_ref())?;
        prop_assert!(close(mean_again.as_ref(), rows(mean.as_ref(), &[0, 1, 0, 1]).as_ref(), 1e-6));
        prop_assert!(close(std_again.as_ref(), rows(std.as_ref(), &[0, 1, 0, 1]).as_ref(), 1e-6));
    }

    #[test]
    fn noise_free_and_repeated_samples_are_survived(seed in any::<u64>(), c in 0.01..10.0_f64) {
        let mut source = Source::new(seed);
        let half = source.matrix(2, 30);
        let x = Mat::from_fn(2, 60, |i, t| half[(i, t % 30)]);
        let y = Mat::from_fn(2, 60, |j, t| (3.0 * x[(j, t)]).sin() * x[(1 - j, t)]);
        let kernel = Kernel::Gaussian(Bandwidth::Relative(c));
        let rvm = MultiOutputRvm { kernel, ..MultiOutputRvm::default() };
        let model = rvm.fit(x.as_ref(), y.as_ref())?.model;
        let (mean, std) = model.predict_with_std(x.as_ref())?;
        prop_assert!(mean.norm_max().is_finite() && std.norm_max().is_finite());
    }

    #[test]
    fn sums_give_the_fit_in_memory(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 6, 3, 50);
        let rvm = MultiOutputRvm { kernel: Kernel::Linear, ..MultiOutputRvm::default() };
        let all: Vec<usize> = (0..50).collect();
        let pilot = PilotSample { x: x.as_ref(), y: y.as_ref(), samples: &all };
        let columns = BasisSpec::new(&pilot, Kernel::Linear)?;
        let mut sums = SufficientStatistics::new(&columns);
        sums.add(&columns, x.as_ref(), y.as_ref())?;
        let (streamed, whole) = (rvm.fit_sums(&columns, &sums)?, rvm.fit(x.as_ref(), y.as_ref())?);
        let (a, b) = (streamed.model.predict(x.as_ref())?, whole.model.predict(x.as_ref())?);
        prop_assert!(close(a.as_ref(), b.as_ref(), 1e-8));
    }
}

#[test]
fn inputs_that_say_nothing_are_dropped_and_the_others_shared() {
    let mut source = Source::new(9);
    let x = source.matrix(30, 300);
    let y = Mat::from_fn(4, 300, |j, t| {
        2.0 * x[(3, t)] + (j as f64 - 1.5) * x[(17, t)] + 0.5 * source.uniform()
    });
    let rvm = MultiOutputRvm { kernel: Kernel::Linear, ..MultiOutputRvm::default() };
    let model = rvm.fit(x.as_ref(), y.as_ref()).unwrap().model;
    let kept = model.selected_features();
    assert!(kept.contains(&3) && kept.contains(&17) && kept.len() <= 16, "{kept:?}");
    let noise = 0.5 / 3_f64.sqrt();
    assert!(model.noise().iter().all(|sigma| (sigma / noise - 1.0).abs() < 0.15));
}
