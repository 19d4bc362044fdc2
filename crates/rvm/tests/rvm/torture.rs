//! Data at the edge of what numbers can hold: an answer as good as they allow, or an error by name.

use faer::{Mat, MatRef};
use phalanx_rvm::{AugmentedRvm, Error, Model, Regressor};
use proptest::prelude::*;

use crate::problems::{FITTERS, Source, smooth};
use crate::property;

/// The errors that a fitter may answer such data with.
fn named(error: &Error) -> bool {
    matches!(error, Error::Singular { .. } | Error::Count { .. } | Error::Eigenvalues { .. })
}

/// Finite predictions, and deviations above 0: infinite where a target does not vary.
fn sound(model: &Model, x: MatRef<'_, f64>) -> bool {
    let (mean, std) = model.predict_with_std(x).unwrap();
    mean.col_iter().all(|c| c.iter().all(|v| v.is_finite())) && positive(&std)
}

fn positive(std: &Mat<f64>) -> bool {
    std.col_iter().all(|c| c.iter().all(|&v| v > 0.0))
}

/// Root mean squared error over the targets' own deviation, of the first target.
fn error(model: &Model, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> f64 {
    let mean = model.predict(x).unwrap();
    let n = y.ncols() as f64;
    let level = y.row(0).iter().sum::<f64>() / n;
    let squared: f64 = (0..y.ncols()).map(|t| (mean[(0, t)] - y[(0, t)]).powi(2)).sum();
    let spread: f64 = y.row(0).iter().map(|v| (v - level).powi(2)).sum();
    (squared / spread).sqrt()
}

proptest! {
    #![proptest_config(property::cases(24))]

    /// Inputs that are almost multiples of one another, down to 1e-14 of their size.
    #[test]
    fn ill_conditioned_inputs(seed in any::<u64>(), digits in 0..15_i32) {
        let (base, y) = smooth(seed, 3, 2, 30);
        let mut source = Source::new(seed ^ 3);
        let x = Mat::from_fn(5, 30, |i, t| match i {
            0..3 => base[(i, t)],
            _ => base[(0, t)] + 10_f64.powi(-digits) * source.uniform(),
        });
        for (name, fit) in FITTERS {
            match fit(x.as_ref(), y.as_ref()) {
                Ok(fit) => {
                    prop_assert!(sound(&fit.model, x.as_ref()), "{name}");
                    let error = error(&fit.model, x.as_ref(), y.as_ref());
                    prop_assert!(error < 1.0 + 1e-6, "{name}: {error}");
                }
                Err(error) => prop_assert!(named(&error), "{name}: {error}"),
            }
        }
    }

    /// Every row of inputs and targets in units of its own, 24 orders of magnitude apart: the same
    /// fit as in equal units.
    #[test]
    fn scales_from_one_end_to_the_other(seed in any::<u64>(), spread in prop::array::uniform5(-12..=12_i32)) {
        let (x, y) = smooth(seed, 3, 2, 30);
        let unit = |row: usize| 10_f64.powi(spread[row]);
        let scaled_x = Mat::from_fn(3, 30, |i, t| unit(i) * x[(i, t)]);
        let scaled_y = Mat::from_fn(2, 30, |j, t| unit(3 + j) * y[(j, t)]);
        for (name, fit) in FITTERS {
            let plain = fit(x.as_ref(), y.as_ref())?.model;
            let scaled = fit(scaled_x.as_ref(), scaled_y.as_ref())?.model;
            let expected = error(&plain, x.as_ref(), y.as_ref());
            let found = error(&scaled, scaled_x.as_ref(), scaled_y.as_ref());
            prop_assert!(sound(&scaled, scaled_x.as_ref()), "{name}");
            prop_assert!((found - expected).abs() < 0.02, "{name}: {found} {expected}");
        }
    }

    /// Few samples, each many times over, beside constant ones and without noise.
    #[test]
    fn repeated_and_constant_samples(seed in any::<u64>(), distinct in 1..5_usize, times in 1..12_usize) {
        let mut source = Source::new(seed);
        let (some_x, some_y) = (source.matrix(3, distinct), source.matrix(2, distinct));
        let n = distinct * times;
        let x = Mat::from_fn(3, n, |i, t| if i == 1 { -7.0 } else { some_x[(i, t % distinct)] });
        let y = Mat::from_fn(2, n, |j, t| some_y[(j, t % distinct)]);
        for (name, fit) in FITTERS {
            match fit(x.as_ref(), y.as_ref()) {
                Ok(fit) => {
                    prop_assert!(sound(&fit.model, x.as_ref()), "{name}");
                    let far = Mat::from_fn(3, 2, |i, t| 1e6 * (i as f64 - t as f64));
                    prop_assert!(sound(&fit.model, far.as_ref()), "{name}");
                    if let Ok(healed) = AugmentedRvm::new(fit.model, x.as_ref(), y.as_ref()) {
                        let (_, std) = healed.predict_with_std(far.as_ref())?;
                        prop_assert!(positive(&std), "{name}");
                    }
                }
                Err(error) => prop_assert!(named(&error), "{name}: {error}"),
            }
        }
    }
}
