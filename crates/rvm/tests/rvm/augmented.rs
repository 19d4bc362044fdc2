//! RVM*: its variance by the augmented machine itself, and what it says near and far.

use faer::Mat;
use faer::linalg::solvers::Solve;
use phalanx_rvm::{
    AugmentedRvm, Basis, Error, KernelRidge, MultiOutputRvm, Posterior, Regressor,
    RelevanceVectorMachine, Ridge, StandardScaler,
};
use proptest::prelude::*;

use crate::problems::smooth;
use crate::property;

proptest! {
    #![proptest_config(property::cases(24))]

    /// Against the posterior of a machine that has the additional column among its own.
    #[test]
    fn the_variance_is_that_of_the_augmented_machine(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 3, 2, 30);
        let model = MultiOutputRvm::default().fit(x.as_ref(), y.as_ref())?.model;
        let at = Mat::from_fn(3, 1, |i, _| 0.3 * i as f64 - 0.2);
        let (_, std) = AugmentedRvm::new(model.clone(), x.as_ref(), y.as_ref())?.predict_with_std(at.as_ref())?;
        let parts = model.parts();
        let (Basis::Gaussian { beta, centres, samples }, Posterior::Weights(factors)) = (&parts.basis, &parts.posterior) else {
            return Err(TestCaseError::fail("not sparse"));
        };
        let p = samples.len();
        let z = |x: &Mat<f64>, t: usize| -> Vec<f64> {
            (0..3).map(|f| (x[(f, t)] - parts.feature_means[f]) / parts.feature_scales[f]).collect()
        };
        let gauss = |a: &[f64], b: &[f64]| (-beta * a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>()).exp();
        let centre = |k: usize| -> Vec<f64> { (0..3).map(|f| centres[f * p + k]).collect() };
        let star = z(&at, 0);
        let column = |k: usize, t: &[f64]| if k < p { gauss(t, &centre(k)) } else { gauss(t, &star) };
        let raw = Mat::from_fn(30, p + 1, |t, k| column(k, &z(&x, t)));
        let means: Vec<f64> = raw.col_iter().map(|c| c.sum() / 30.0).collect();
        let phi = Mat::from_fn(30, p + 1, |t, k| raw[(t, k)] - means[k]);
        let here = Mat::from_fn(p + 1, 1, |k, _| column(k, &star) - means[k]);
        // Σ = MᵀM, and its inverse is A + ΦᵀΦ.
        let factor = &factors[0];
        let mut m = Mat::<f64>::zeros(p, p);
        let mut packed = factor.packed.iter();
        for j in 0..p {
            for i in j..p {
                m[(i, factor.columns[j])] = *packed.next().unwrap();
            }
        }
        let inverse = (m.transpose() * &m).full_piv_lu().solve(Mat::<f64>::identity(p, p));
        let gram = phi.transpose() * &phi;
        let scale = StandardScaler::fit(y.as_ref())?;
        for j in 0..2 {
            let alpha = (parts.noise[j] / scale.scale()[j]).powi(2);
            let system = Mat::from_fn(p + 1, p + 1, |i, k| match (i == p, k == p) {
                (false, false) => inverse[(i, k)],
                (true, true) => alpha + gram[(p, p)],
                _ => gram[(i, k)],
            });
            let spread = (here.transpose() * system.full_piv_lu().solve(&here))[(0, 0)];
            let expected = parts.noise[j] * (1.0 + spread).sqrt();
            prop_assert!((std[(j, 0)] / expected - 1.0).abs() < 1e-4, "{} {expected}", std[(j, 0)]);
        }
    }

    #[test]
    fn it_is_never_surer_than_the_plain_one_and_far_away_as_unsure_as_the_target(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 3, 2, 50);
        let model = RelevanceVectorMachine { restarts: 0, ..RelevanceVectorMachine::default() }.fit(x.as_ref(), y.as_ref())?.model;
        prop_assume!(!model.kept_samples().is_empty());
        let healed = AugmentedRvm::new(model.clone(), x.as_ref(), y.as_ref())?;
        let (plain_mean, plain) = model.predict_with_std(x.as_ref())?;
        let (mean, std) = healed.predict_with_std(x.as_ref())?;
        prop_assert_eq!(plain_mean, mean);
        prop_assert!((0..50).all(|t| (0..2).all(|j| std[(j, t)] >= plain[(j, t)] * (1.0 - 1e-12))));
        let far = Mat::from_fn(3, 1, |_, _| 1e3);
        let (_, std) = healed.predict_with_std(far.as_ref())?;
        let (_, plain) = model.predict_with_std(far.as_ref())?;
        let scale = StandardScaler::fit(y.as_ref())?;
        for j in 0..2 {
            let expected = plain[(j, 0)].hypot(scale.scale()[j]);
            prop_assert!((std[(j, 0)] / expected - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn what_cannot_be_healed_is_named() {
    let (x, y) = smooth(2, 3, 2, 20);
    let (x, y) = (x.as_ref(), y.as_ref());
    for fit in [Ridge::default().fit(x, y), KernelRidge::default().fit(x, y)] {
        assert_eq!(AugmentedRvm::new(fit.unwrap().model, x, y).unwrap_err(), Error::NotSparse);
    }
}
