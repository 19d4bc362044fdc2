//! Kernel ridge regression against refitting without each sample, and as a Gaussian process.

use faer::{Mat, MatRef};
use phalanx_rvm::{Bandwidth, KernelRidge, Regressor, Regularisation, StandardScaler};
use proptest::prelude::*;

use crate::problems::{smooth, solve};
use crate::property;

const BETA: f64 = 0.2;

fn kernel(a: MatRef<'_, f64>, i: usize, b: MatRef<'_, f64>, j: usize) -> f64 {
    (-BETA * (a.col(i) - b.col(j)).squared_norm_l2()).exp()
}

/// [K + λI, 1; 1ᵀ, 0] over the samples in `kept`: kernel ridge with a free bias.
fn bordered(z: MatRef<'_, f64>, kept: &[usize], lambda: f64) -> Mat<f64> {
    let n = kept.len();
    Mat::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
        (true, true) => kernel(z, kept[i], z, kept[j]) + if i == j { lambda } else { 0.0 },
        (false, false) => 0.0,
        _ => 1.0,
    })
}

fn fitter(lambda: Regularisation) -> KernelRidge {
    KernelRidge { bandwidth: Bandwidth::Gamma(BETA), regularisation: lambda }
}

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn leave_one_out_is_refitting_without_each_sample(seed in any::<u64>()) {
        let (n, m) = (20, 2);
        let (x, y) = smooth(seed, 3, m, n);
        let z = StandardScaler::fit(x.as_ref())?.apply(x.as_ref())?;
        let targets = StandardScaler::fit(y.as_ref())?.apply(y.as_ref())?;
        let grid = vec![1e-3, 0.1, 3.0];
        let brute = |lambda: f64| {
            let mut total = 0.0;
            for left in 0..n {
                let kept: Vec<usize> = (0..n).filter(|&i| i != left).collect();
                let right = Mat::from_fn(n, m, |i, j| kept.get(i).map_or(0.0, |&s| targets[(j, s)]));
                let dual = solve(bordered(z.as_ref(), &kept, lambda).as_ref(), right.as_ref());
                for j in 0..m {
                    let predicted: f64 = dual[(n - 1, j)] + kept.iter().enumerate()
                        .map(|(i, &s)| dual[(i, j)] * kernel(z.as_ref(), s, z.as_ref(), left))
                        .sum::<f64>();
                    total += (predicted - targets[(j, left)]).powi(2);
                }
            }
            total / (n * m) as f64
        };
        let fit = fitter(Regularisation::Loocv(grid.clone())).fit(x.as_ref(), y.as_ref())?;
        let expected: Vec<f64> = grid.iter().map(|&lambda| brute(lambda)).collect();
        for (found, expected) in fit.report.traces[0].objective.iter().zip(&expected) {
            prop_assert!((found - expected).abs() < 1e-7 * expected, "{found} {expected}");
        }
        let best = (0..grid.len()).min_by(|&a, &b| expected[a].total_cmp(&expected[b]));
        prop_assert_eq!(fit.report.penalty, best.map(|b| grid[b]));
        let given = fitter(Regularisation::Fixed(fit.report.penalty.unwrap())).fit(x.as_ref(), y.as_ref())?;
        prop_assert_eq!(given.model, fit.model);
    }

    #[test]
    fn it_is_a_gaussian_process_with_a_free_bias(seed in any::<u64>(), lambda in 0.01..2.0_f64) {
        let (n, m) = (25, 2);
        let (x, y) = smooth(seed, 3, m, n);
        let (new, _) = smooth(seed ^ 7, 3, 1, 10);
        let (inputs, outputs) = (StandardScaler::fit(x.as_ref())?, StandardScaler::fit(y.as_ref())?);
        let (z, w) = (inputs.apply(x.as_ref())?, inputs.apply(new.as_ref())?);
        let targets = outputs.apply(y.as_ref())?;
        let all: Vec<usize> = (0..n).collect();
        let system = bordered(z.as_ref(), &all, lambda);
        let right = Mat::from_fn(n + 1, m, |i, j| if i < n { targets[(j, i)] } else { 0.0 });
        let dual = solve(system.as_ref(), right.as_ref());
        let model = fitter(Regularisation::Fixed(lambda)).fit(x.as_ref(), y.as_ref())?.model;
        let (mean, std) = model.predict_with_std(new.as_ref())?;
        for t in 0..10 {
            let k = Mat::from_fn(n + 1, 1, |i, _| {
                if i < n { kernel(z.as_ref(), i, w.as_ref(), t) } else { 1.0 }
            });
            // The bordered system's quadratic form is the process's variance, bias and all.
            let variance = 1.0 - (k.transpose() * solve(system.as_ref(), k.as_ref()))[(0, 0)];
            for j in 0..m {
                let expected = outputs.mean()[j]
                    + outputs.scale()[j] * (k.transpose() * dual.col(j))[0];
                prop_assert!((mean[(j, t)] - expected).abs() < 1e-8 * outputs.scale()[j]);
                let multiple = (std[(j, t)] / model.noise()[j]).powi(2) - 1.0;
                prop_assert!((multiple - variance / lambda).abs() < 1e-7 * (1.0 + 1.0 / lambda));
            }
        }
    }
}
