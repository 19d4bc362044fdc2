//! Bridges against a literal transcription of the paper's section 4.

use faer::{Mat, MatRef};
use phalanx_rvm::{
    AgarwalTriggs, Bandwidth, Kernel, Regressor, StandardScaler, Stop, TwoStageSelection,
};
use proptest::prelude::*;

use crate::problems::{GAUSSIAN, close, rows, smooth, solve};
use crate::property;

/// A F̃ = Ỹ in least squares, with one row of F̃ per sample and one per penalised column.
fn least_squares(f: MatRef<'_, f64>, y: MatRef<'_, f64>, penalties: &[f64]) -> Mat<f64> {
    let (p, i) = f.shape();
    let mut augmented = Mat::zeros(p, i + p);
    augmented.as_mut().subcols_mut(0, i).copy_from(f);
    for (k, penalty) in penalties.iter().enumerate() {
        augmented[(k, i + k)] = penalty.sqrt();
    }
    let mut targets = Mat::zeros(y.nrows(), i + p);
    targets.as_mut().subcols_mut(0, i).copy_from(y);
    let normal = &augmented * augmented.transpose();
    let right = &augmented * targets.transpose();
    solve(normal.as_ref(), right.as_ref()).transpose().to_owned()
}

/// The paper's iteration, with columns kept by index and nothing clever.
fn transcription(
    f: MatRef<'_, f64>,
    y: MatRef<'_, f64>,
    bridges: &AgarwalTriggs,
    threshold: f64,
) -> (Vec<usize>, Mat<f64>) {
    let nu = bridges.nu * y.nrows() as f64;
    let mut kept: Vec<usize> = (0..f.nrows()).collect();
    let mut a = least_squares(f, y, &vec![bridges.lambda; kept.len()]);
    for _ in 0..bridges.max_iterations {
        let penalties: Vec<f64> =
            a.col_iter().map(|column| nu / column.squared_norm_l2()).collect();
        let next = least_squares(rows(f, &kept).as_ref(), y, &penalties);
        let change = (&next - &a).norm_l2() / next.norm_l2();
        let survivors: Vec<usize> =
            (0..kept.len()).filter(|&k| next.col(k).norm_l2() > threshold).collect();
        a = Mat::from_fn(y.nrows(), survivors.len(), |j, k| next[(j, survivors[k])]);
        let pruned = survivors.len() < kept.len();
        kept = survivors.iter().map(|&k| kept[k]).collect();
        if !pruned && change <= bridges.tolerance {
            break;
        }
    }
    (kept, a)
}

/// Centred Gaussian columns of standardised inputs, I×I.
fn gaussian(z: MatRef<'_, f64>, beta: f64) -> Mat<f64> {
    let n = z.ncols();
    let k = Mat::from_fn(n, n, |i, j| (-beta * (z.col(i) - z.col(j)).squared_norm_l2()).exp());
    Mat::from_fn(n, n, |i, j| k[(i, j)] - k.row(i).iter().sum::<f64>() / n as f64)
}

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn bridges_are_the_papers_iteration(
        seed in any::<u64>(),
        linear in any::<bool>(),
        nu in 0.01..0.3_f64,
    ) {
        let (x, y) = smooth(seed, 7, 3, 30);
        let threshold = 0.02;
        let kernel = if linear { Kernel::Linear } else { GAUSSIAN };
        let bridges = AgarwalTriggs {
            kernel, nu, stop: Stop::Threshold(threshold), ..AgarwalTriggs::default()
        };
        let scale = StandardScaler::fit(y.as_ref())?;
        let z = StandardScaler::fit(x.as_ref())?.apply(x.as_ref())?;
        let f = if linear { z } else { gaussian(z.as_ref(), 1.0 / 14.0) };
        let targets = scale.apply(y.as_ref())?;
        let (kept, a) = transcription(f.as_ref(), targets.as_ref(), &bridges, threshold);
        let model = bridges.fit(x.as_ref(), y.as_ref())?.model;
        let found = if linear { model.selected_features() } else { model.kept_samples() };
        prop_assert_eq!(found, &kept);
        let expected = Mat::from_fn(3, kept.len(), |j, k| scale.scale()[j] * a[(j, k)]);
        prop_assert!(close(model.weights(), expected.as_ref(), 1e-4));
    }

    #[test]
    fn each_step_lowers_the_objective(seed in any::<u64>(), nu in 0.001..0.3_f64) {
        let (x, y) = smooth(seed, 7, 3, 30);
        let bridges = AgarwalTriggs { nu, stop: Stop::Threshold(0.0), ..AgarwalTriggs::default() };
        let fit = bridges.fit(x.as_ref(), y.as_ref())?;
        // Nothing is dropped before a norm underflows, which takes more steps than these.
        let objective = &fit.report.traces[0].objective;
        let early = &objective[..objective.len().min(6)];
        prop_assert!(early.is_sorted_by(|a, b| *b <= a + 1e-9 * a.abs().max(1.0)), "{early:?}");
    }

    #[test]
    fn a_count_is_met(seed in any::<u64>(), count in 1..=12_usize, nu in 0.001..1.0_f64) {
        let (x, y) = smooth(seed, 12, 3, 30);
        for kernel in [Kernel::Linear, GAUSSIAN] {
            let bridges = AgarwalTriggs { kernel, nu, stop: Stop::Count(count), ..AgarwalTriggs::default() };
            let fit = bridges.fit(x.as_ref(), y.as_ref())?;
            let norms: Vec<f64> =
                fit.model.weights().col_iter().map(|column| column.norm_l2()).collect();
            prop_assert_eq!(norms.len(), count);
            // All of them live: one on its way to zero shrinks quadratically.
            let largest = norms.iter().fold(0.0_f64, |m, v| m.max(*v));
            prop_assert!(norms.iter().all(|norm| *norm > 1e-5 * largest), "{norms:?}");
        }
    }

    #[test]
    fn a_cascade_reads_only_its_features(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 10, 3, 40);
        let cascade = TwoStageSelection {
            features: Stop::Count(4), samples: Stop::Count(9), ..TwoStageSelection::default()
        };
        let model = cascade.fit(x.as_ref(), y.as_ref())?.model;
        prop_assert_eq!(model.selected_features().len(), 4);
        prop_assert_eq!(model.kept_samples().len(), 9);
        let read = model.selected_features();
        let blotted = Mat::from_fn(10, 40, |i, t| {
            if read.contains(&i) { x[(i, t)] } else { f64::NAN }
        });
        prop_assert_eq!(model.predict(blotted.as_ref())?, model.predict(x.as_ref())?);
    }
}

#[test]
fn everything_pruned_leaves_the_mean() {
    let (x, y) = smooth(5, 3, 2, 25);
    let bridges = AgarwalTriggs { stop: Stop::Threshold(1e9), ..AgarwalTriggs::default() };
    let fit = bridges.fit(x.as_ref(), y.as_ref()).unwrap();
    assert!(fit.report.converged && fit.model.weights().ncols() == 0);
    let (mean, std) = fit.model.predict_with_std(x.as_ref()).unwrap();
    let scale = StandardScaler::fit(y.as_ref()).unwrap();
    for j in 0..2 {
        assert_eq!(mean[(j, 7)], scale.mean()[j]);
        let deviation = scale.scale()[j] * (25.0_f64 / 24.0).sqrt();
        assert!((std[(j, 7)] / deviation - 1.0).abs() < 1e-12);
    }
}

#[test]
fn the_sign_of_beta_does_not_matter() {
    let (x, y) = smooth(6, 3, 2, 25);
    let fit = |beta| {
        let kernel = Kernel::Gaussian(Bandwidth::Gamma(beta));
        AgarwalTriggs { kernel, ..AgarwalTriggs::default() }.fit(x.as_ref(), y.as_ref()).unwrap()
    };
    assert_eq!(fit(0.2), fit(-0.2));
}
