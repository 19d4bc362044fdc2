//! What must not matter: the order of samples and of targets, the targets' units, the threads.

use faer::Mat;
use phalanx_rvm::{AgarwalTriggs, Kernel, Regressor, Stop};
use proptest::prelude::*;

use crate::problems::{FITTERS, Source, close, columns, rows, smooth};
use crate::property;

/// Targets without noise leave the evidence flat, and rounding leads elsewhere on it: in one of 5,000 orders by 1.1e-5.
const OF_ORDER: f64 = 1e-4;

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn the_order_of_samples_does_not_matter(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 4, 3, 40);
        let order = Source::new(seed ^ 1).order(40);
        let (shuffled_x, shuffled_y) = (columns(x.as_ref(), &order), columns(y.as_ref(), &order));
        for (name, fit) in FITTERS {
            let (mean, std) = fit(x.as_ref(), y.as_ref())?.model.predict_with_std(x.as_ref())?;
            let shuffled = fit(shuffled_x.as_ref(), shuffled_y.as_ref())?.model;
            let (other_mean, other_std) = shuffled.predict_with_std(x.as_ref())?;
            prop_assert!(close(other_mean.as_ref(), mean.as_ref(), OF_ORDER), "{name}");
            prop_assert!(close(other_std.as_ref(), std.as_ref(), OF_ORDER), "{name}");
        }
    }

    #[test]
    fn the_order_of_targets_does_not_matter(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 4, 3, 40);
        let order = Source::new(seed ^ 2).order(3);
        let shuffled_y = rows(y.as_ref(), &order);
        for (name, fit) in FITTERS {
            let (mean, std) = fit(x.as_ref(), y.as_ref())?.model.predict_with_std(x.as_ref())?;
            let shuffled = fit(x.as_ref(), shuffled_y.as_ref())?.model;
            let (other_mean, other_std) = shuffled.predict_with_std(x.as_ref())?;
            let (mean, std) = (rows(mean.as_ref(), &order), rows(std.as_ref(), &order));
            prop_assert!(close(other_mean.as_ref(), mean.as_ref(), OF_ORDER), "{name}");
            prop_assert!(close(other_std.as_ref(), std.as_ref(), OF_ORDER), "{name}");
        }
    }

    #[test]
    fn predictions_scale_and_shift_with_the_targets(
        seed in any::<u64>(),
        scale in 1e-3..1e3_f64,
        shift in -10.0..10.0_f64,
    ) {
        let (x, y) = smooth(seed, 4, 2, 40);
        // Targets without noise leave the evidence flat, and rounding leads elsewhere on it: in one of 400 by 2e-5.
        let scaled_y = Mat::from_fn(2, 40, |j, t| scale * y[(j, t)] + shift);
        for (name, fit) in FITTERS {
            let (mean, std) = fit(x.as_ref(), y.as_ref())?.model.predict_with_std(x.as_ref())?;
            let scaled = fit(x.as_ref(), scaled_y.as_ref())?.model;
            let (other_mean, other_std) = scaled.predict_with_std(x.as_ref())?;
            let mean = Mat::from_fn(2, 40, |j, t| scale * mean[(j, t)] + shift);
            let std = Mat::from_fn(2, 40, |j, t| scale * std[(j, t)]);
            prop_assert!(close(other_mean.as_ref(), mean.as_ref(), 1e-3), "{name}");
            prop_assert!(close(other_std.as_ref(), std.as_ref(), 1e-3), "{name}");
        }
    }

    #[test]
    fn targets_given_twice_change_no_selection(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 6, 2, 40);
        let twice = rows(y.as_ref(), &[0, 1, 0, 1]);
        let bridges = AgarwalTriggs { kernel: Kernel::Linear, stop: Stop::Count(3), ..AgarwalTriggs::default() };
        let once = bridges.fit(x.as_ref(), y.as_ref())?.model;
        let again = bridges.fit(x.as_ref(), twice.as_ref())?.model;
        prop_assert_eq!(once.selected_features(), again.selected_features());
        let expected = rows(once.weights(), &[0, 1, 0, 1]);
        prop_assert!(close(again.weights(), expected.as_ref(), 1e-5));
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let (x, y) = smooth(3, 12, 5, 230);
    for (name, fit) in FITTERS {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let fit = fit(x.as_ref(), y.as_ref()).unwrap();
                let predictions = fit.model.predict_with_std(x.as_ref()).unwrap();
                // Shortest round-trip decimals: equal text means equal bits.
                format!("{fit:?} {predictions:?}")
            })
        };
        let one = run(1);
        assert!(one == run(2) && one == run(8), "{name}");
    }
}
