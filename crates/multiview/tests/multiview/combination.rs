//! Joining estimates of single views.

use phalanx_multiview::{Error, Estimate, inverse_variance, mean};
use proptest::prelude::*;

use crate::property;

const OUTPUTS: usize = 4;

/// Views of some outputs: estimates and deviations.
fn views() -> impl Strategy<Value = Vec<(Vec<f64>, Vec<f64>)>> {
    let numbers = |range| prop::collection::vec(range, OUTPUTS);
    prop::collection::vec((numbers(-3.0..3.0), numbers(0.01..2.0)), 1..6)
}

fn estimates(views: &[(Vec<f64>, Vec<f64>)]) -> Vec<Estimate<'_>> {
    views.iter().map(|(mean, std)| Estimate { mean, std }).collect()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * (1.0 + a.abs())
}

proptest! {
    #![proptest_config(property::cases(64))]

    #[test]
    fn weights_are_the_textbook_s(views in views()) {
        let (joined, std) = inverse_variance(&estimates(&views)).unwrap();
        for k in 0..OUTPUTS {
            let precision: f64 = views.iter().map(|(_, std)| std[k].powi(-2)).sum();
            let weighted: f64 = views.iter().map(|(mean, std)| mean[k] * std[k].powi(-2)).sum();
            prop_assert!(near(joined[k], weighted / precision));
            prop_assert!(near(std[k], precision.sqrt().recip()));
        }
    }

    #[test]
    fn equal_deviations_give_the_mean(views in views(), std in 0.0_f64..2.0) {
        let alike: Vec<_> = views.iter().map(|(mean, _)| (mean.clone(), vec![std; OUTPUTS])).collect();
        let means: Vec<_> = views.iter().map(|(mean, _)| mean.clone()).collect();
        let joined = inverse_variance(&estimates(&alike)).unwrap().0;
        for (a, b) in joined.into_iter().zip(mean(&means).unwrap()) {
            prop_assert!(near(a, b));
        }
    }
}

#[test]
fn tiny_and_zero_deviations_are_certainty() {
    let joined = |std: [f64; 3]| {
        let views = [1.0, 3.0, 8.0].map(|value| [value]);
        let std = std.map(|std| [std]);
        let pairs = views.iter().zip(&std);
        let estimates: Vec<_> = pairs.map(|(mean, std)| Estimate { mean, std }).collect();
        let (mean, std) = inverse_variance(&estimates).unwrap();
        (mean[0], std[0])
    };
    assert_eq!(joined([0.0, 0.0, 1.0]), (2.0, 0.0), "two views are certain");
    assert_eq!(joined([1.0, 1.0, 0.0]), (8.0, 0.0));
    assert_eq!(joined([1e-200, 1.0, 1.0]), (1.0, 1e-200), "whose square is 0");
}

#[test]
fn what_cannot_be_joined_is_named() {
    let message = |error: Error| error.to_string();
    assert_eq!(message(mean::<Vec<f64>>(&[]).unwrap_err()), "there is no view");
    assert_eq!(message(inverse_variance(&[]).unwrap_err()), "there is no view");
    assert_eq!(
        message(mean(&[vec![0.0; 2], vec![0.0; 3]]).unwrap_err()),
        "view 1 has 3 numbers for 2 outputs"
    );
    assert_eq!(
        message(mean(&[[0.0, f64::NAN]]).unwrap_err()),
        "view 0, output 1: NaN is no number to join"
    );
    let joined = |std: &[f64]| {
        let sure = Estimate { mean: &[0.0], std: &[1.0] };
        message(inverse_variance(&[sure, Estimate { mean: &[1.0], std }]).unwrap_err())
    };
    assert_eq!(joined(&[-0.5]), "view 1, output 0: -0.5 is no standard deviation");
    assert_eq!(joined(&[f64::INFINITY]), "view 1, output 0: inf is no number to join");
    assert_eq!(joined(&[]), "view 1 has 0 numbers for 1 outputs");
}
