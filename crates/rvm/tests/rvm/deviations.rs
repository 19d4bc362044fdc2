//! No certainty out of nothing: from one sample, or of a target that does not vary.

use faer::{Mat, MatRef};
use phalanx_rvm::{
    AugmentedRvm, MlpTrainer, Model, NystromRidge, PredictiveDeviation, Regressor,
    RelevanceVectorMachine, ResidualKde, Scratch,
};
use proptest::prelude::*;

use crate::problems::{FITTERS, Source, smooth};
use crate::property;

/// The deviations at the samples and far from them.
fn deviations(model: &Model, x: MatRef<'_, f64>) -> [Mat<f64>; 2] {
    let far = Mat::from_fn(x.nrows(), x.ncols(), |i, t| x[(i, t)] + 1e4);
    [x, far.as_ref()].map(|x| model.predict_with_std(x).unwrap().1)
}

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn one_sample_tells_no_deviation(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 3, 2, 1);
        for (name, fit) in FITTERS {
            let Ok(fit) = fit(x.as_ref(), y.as_ref()) else { continue };
            prop_assert!(fit.model.noise().iter().all(|noise| noise.is_infinite()), "{name}");
            for std in deviations(&fit.model, x.as_ref()) {
                prop_assert!((0..2).all(|j| std[(j, 0)] == f64::INFINITY), "{name}");
            }
        }
    }

    #[test]
    fn a_constant_target_tells_none_and_leaves_the_others_alone(seed in any::<u64>(), level in -5.0..5.0_f64) {
        let (x, mut y) = smooth(seed, 3, 2, 30);
        y.row_mut(1).fill(level);
        for (name, fit) in FITTERS {
            let model = fit(x.as_ref(), y.as_ref())?.model;
            prop_assert!(model.noise()[1] == f64::INFINITY && model.noise()[0] > 0.0, "{name}");
            for std in deviations(&model, x.as_ref()) {
                prop_assert!(std.row(1).iter().all(|&v| v == f64::INFINITY), "{name}");
                prop_assert!(std.row(0).iter().all(|&v| v > 0.0 && v.is_finite()), "{name}");
            }
            let mean = model.predict(x.as_ref())?;
            prop_assert!(mean.row(1).iter().all(|&v| (v - level).abs() < 1e-9), "{name}");
        }
    }

    /// As many columns as samples: residuals of next to nothing are no measure of the noise.
    #[test]
    fn a_fit_that_uses_up_all_samples_has_the_targets_own_deviation(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 5, 1, 4);
        for deviation in [PredictiveDeviation::Posterior, PredictiveDeviation::Gcv] {
            let penalty = phalanx_rvm::NystromRegularisation::Fixed(1e-9);
            let nystrom = NystromRidge { regularisation: penalty, deviation, ..NystromRidge::default() };
            let model = nystrom.fit(x.as_ref(), y.as_ref())?.model;
            let scale = phalanx_rvm::StandardScaler::fit(y.as_ref())?.scale()[0];
            prop_assert!(model.noise()[0] > 0.99 * scale, "{} {scale}", model.noise()[0]);
        }
    }
}

#[test]
fn an_augmented_machine_knows_none_either() {
    let (x, mut y) = smooth(3, 2, 2, 40);
    y.row_mut(1).fill(0.25);
    let model = RelevanceVectorMachine::default().fit(x.as_ref(), y.as_ref()).unwrap().model;
    let healed = AugmentedRvm::new(model, x.as_ref(), y.as_ref()).unwrap();
    let (_, std) = healed.predict_with_std(x.as_ref()).unwrap();
    assert!(std.row(1).iter().all(|&v| v == f64::INFINITY));
    assert!(std.row(0).iter().all(|&v| v > 0.0 && v.is_finite()));
}

/// Too few samples to hold some out: the targets' own deviations.
#[test]
fn a_network_of_few_samples_knows_no_more_than_the_targets_tell() {
    let (x, mut y) = smooth(3, 2, 2, 100);
    y.row_mut(1).fill(0.25);
    let fitter = MlpTrainer { hidden: vec![8], epochs: 5, batch: 16, ..MlpTrainer::default() };
    let network = fitter.fit(x.as_ref(), y.as_ref()).unwrap().model;
    let (mut mean, mut std) = ([0.0; 2], [0.0; 2]);
    network.predict_into(&[0.1, 0.2], &mut Scratch::default(), &mut mean, &mut std).unwrap();
    let scale = phalanx_rvm::StandardScaler::fit(y.as_ref()).unwrap().scale()[0];
    assert_eq!(std, [scale, f64::INFINITY]);
}

/// Hypotheses that one sample stands for have the deviation of all samples nearby.
#[test]
fn a_hypothesis_of_one_sample_has_the_deviation_of_its_neighbourhood() {
    let predictions = Mat::zeros(2, 9);
    let residual = |t: usize| if t == 0 { 3.0 } else { 0.01 * t as f64 };
    let truth = Mat::from_fn(2, 9, |j, t| if j == 0 { residual(t) } else { 0.0 });
    let density = ResidualKde::fit(predictions.as_ref(), truth.as_ref(), &[1.0, 1.0], 9).unwrap();
    let hypotheses = density.hypotheses(&[0.0, 0.0], 3).unwrap();
    let lonely = hypotheses.iter().find(|h| (h.mean[0] - 3.0).abs() < 1e-9).expect("the outlier's");
    let all = ((0..9).map(|t| residual(t).powi(2)).sum::<f64>() / 9.0).sqrt();
    assert!((lonely.std[0] - all).abs() < 1e-12, "{} {all}", lonely.std[0]);
    assert!(hypotheses.iter().all(|h| h.std[0] > 0.0 && h.std[1] == f64::INFINITY));
}

/// The same order of magnitude as errors on new samples, where there are a few samples only.
#[test]
fn few_samples_are_not_taken_for_certain() {
    let mut source = Source::new(8);
    for (name, fit) in FITTERS {
        let (x, y) = (source.matrix(2, 3), source.matrix(1, 3));
        let Ok(fit) = fit(x.as_ref(), y.as_ref()) else { continue };
        for std in deviations(&fit.model, x.as_ref()) {
            let least = 1e-3 * y.norm_max();
            assert!(std.col_iter().all(|c| c[0] > least), "{name}: {std:?}");
        }
    }
}
