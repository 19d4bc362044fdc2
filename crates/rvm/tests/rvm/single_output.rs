//! Tipping's machine from outside: its evidence, its sparsity, its honesty.

use faer::Mat;
use phalanx_rvm::{Bandwidth, Kernel, Regressor, RelevanceVectorMachine};
use proptest::prelude::*;

use crate::problems::{GAUSSIAN, Source, smooth};
use crate::property;

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn the_evidence_never_falls(seed in any::<u64>(), linear in any::<bool>()) {
        let (x, y) = smooth(seed, 8, 3, 50);
        let kernel = if linear { Kernel::Linear } else { GAUSSIAN };
        let fit = RelevanceVectorMachine { kernel, min_evidence_gain: 0.0, ..RelevanceVectorMachine::default() }.fit(x.as_ref(), y.as_ref())?;
        prop_assert!(fit.report.converged);
        for trace in &fit.report.traces {
            let evidence = &trace.objective;
            let rises = evidence.is_sorted_by(|a, b| *b >= a - 1e-9 * a.abs().max(1.0));
            prop_assert!(rises, "{evidence:?}");
        }
    }

    #[test]
    fn restarts_find_no_less(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 3, 1, 60);
        let evidence = |restarts| {
            let tipping = RelevanceVectorMachine { kernel: GAUSSIAN, min_evidence_gain: 0.0, restarts, ..RelevanceVectorMachine::default() };
            let fit = tipping.fit(x.as_ref(), y.as_ref())?;
            Ok::<_, phalanx_rvm::Error>(fit.report.traces[0].objective.last().copied())
        };
        prop_assert!(evidence(12)? >= evidence(0)?);
    }

    #[test]
    fn a_price_is_paid_by_fewer_columns(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 3, 1, 60);
        let fit = |price| RelevanceVectorMachine { kernel: GAUSSIAN, min_evidence_gain: price, ..RelevanceVectorMachine::default() }.fit(x.as_ref(), y.as_ref());
        let (dear, none) = (fit(5.0)?, fit(1e6)?);
        prop_assert!(dear.model.kept_samples().len() <= fit(0.0)?.model.kept_samples().len());
        // With every column pruned the model is the mean.
        prop_assert!(none.model.kept_samples().is_empty() && none.report.converged);
        let mean = y.row(0).iter().sum::<f64>() / 60.0;
        let predicted = none.model.predict(x.as_ref())?;
        prop_assert!(predicted.row(0).iter().all(|v| (v - mean).abs() < 1e-12 * (1.0 + mean.abs())));
    }

    #[test]
    fn noise_free_and_repeated_samples_are_survived(seed in any::<u64>(), c in 0.01..10.0_f64) {
        let mut source = Source::new(seed);
        let half = source.matrix(2, 30);
        let x = Mat::from_fn(2, 60, |i, t| half[(i, t % 30)]);
        let y = Mat::from_fn(1, 60, |_, t| (3.0 * x[(0, t)]).sin() * x[(1, t)]);
        let kernel = Kernel::Gaussian(Bandwidth::Relative(c));
        let model = RelevanceVectorMachine { kernel, ..RelevanceVectorMachine::default() }.fit(x.as_ref(), y.as_ref())?.model;
        let (mean, std) = model.predict_with_std(x.as_ref())?;
        prop_assert!(mean.norm_max().is_finite() && std.norm_max().is_finite());
    }
}

#[test]
fn sinc_is_learnt_from_few_vectors() {
    let mut source = Source::new(1);
    let x = Mat::from_fn(1, 200, |_, t| 20.0 * (t as f64 / 199.0 - 0.5));
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
    let noise: Vec<f64> = (0..200).map(|_| 0.1 * 3_f64.sqrt() * source.uniform()).collect();
    let y = Mat::from_fn(1, 200, |_, t| sinc(x[(0, t)]) + noise[t]);
    let kernel = Kernel::Gaussian(Bandwidth::Relative(7.0));
    let model = RelevanceVectorMachine { kernel, ..RelevanceVectorMachine::default() }
        .fit(x.as_ref(), y.as_ref())
        .unwrap()
        .model;
    assert!(model.kept_samples().len() <= 12, "{:?}", model.kept_samples());
    assert!((model.noise()[0] / 0.1 - 1.0).abs() < 0.15, "{:?}", model.noise());
    let mean = model.predict(x.as_ref()).unwrap();
    let error: f64 =
        (0..200).map(|t| (mean[(0, t)] - sinc(x[(0, t)])).powi(2)).sum::<f64>() / 200.0;
    assert!(error.sqrt() < 0.04, "{}", error.sqrt());
}

#[test]
fn inputs_that_say_nothing_are_mostly_dropped() {
    let mut source = Source::new(9);
    let x = source.matrix(30, 300);
    let y = Mat::from_fn(1, 300, |_, t| 2.0 * x[(3, t)] - x[(17, t)] + 0.5 * source.uniform());
    let fit =
        RelevanceVectorMachine { kernel: Kernel::Linear, ..RelevanceVectorMachine::default() };
    let model = fit.fit(x.as_ref(), y.as_ref()).unwrap().model;
    let kept = model.selected_features();
    assert!(kept.contains(&3) && kept.contains(&17) && kept.len() <= 16, "{kept:?}");
}
