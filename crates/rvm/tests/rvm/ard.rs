//! Learnt widths from outside: their evidence, and what they find irrelevant.

use faer::Mat;
use phalanx_rvm::{ArdRvm, Error, Kernel, LengthScales, MultiOutputRvm};
use proptest::prelude::*;

use crate::problems::{Source, smooth};
use crate::property;

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn the_evidence_never_falls(seed in any::<u64>(), tie in 0..3) {
        let (x, y) = smooth(seed, 4, 2, 40);
        let tie = [LengthScales::Shared, LengthScales::Ard, LengthScales::Blocks(vec![1, 3])][tie as usize].clone();
        let rvm = MultiOutputRvm { min_evidence_gain: 0.0, ..MultiOutputRvm::default() };
        let fit = ArdRvm { rvm, length_scales: tie, ..ArdRvm::default() }.fit(x.as_ref(), y.as_ref())?;
        let evidence = &fit.report.traces[0].objective;
        prop_assert!(evidence.is_sorted_by(|a, b| *b >= a - 1e-6 * a.abs().max(1.0)), "{evidence:?}");
        let fixed = rvm.fit(x.as_ref(), y.as_ref())?.report.traces[0].objective.last().copied();
        prop_assert!(evidence.last().copied() >= fixed);
    }
}

/// Two inputs of six matter, one of them three times as much.
fn two_of_six(samples: usize) -> (Mat<f64>, Mat<f64>) {
    let mut source = Source::new(4);
    let x = source.matrix(6, samples);
    let y = Mat::from_fn(1, samples, |_, t| {
        (3.0 * x[(1, t)]).sin() + x[(4, t)].cos() + 0.05 * source.uniform()
    });
    (x, y)
}

#[test]
fn inputs_that_say_nothing_get_long_scales() {
    let (x, y) = two_of_six(200);
    let model = ArdRvm::default().fit(x.as_ref(), y.as_ref()).unwrap().model;
    let scales = model.length_scales().unwrap();
    let of = |input: usize| {
        let place = model.selected_features().iter().position(|&f| f == input);
        place.map_or(f64::INFINITY, |place| scales[place])
    };
    assert!(of(1) < of(4), "{scales:?}");
    for nothing in [0, 2, 3, 5] {
        assert!(of(nothing) > 5.0 * of(4), "{scales:?}");
    }
    // And that is what fewer vectors and smaller errors come from.
    let fixed = MultiOutputRvm::default().fit(x.as_ref(), y.as_ref()).unwrap().model;
    assert!(2 * model.kept_samples().len() < fixed.kept_samples().len());
}

#[test]
fn what_cannot_be_learnt_is_named() {
    let (x, y) = two_of_six(20);
    let linear = MultiOutputRvm { kernel: Kernel::Linear, ..MultiOutputRvm::default() };
    let learn = |learnt: ArdRvm| learnt.fit(x.as_ref(), y.as_ref()).unwrap_err();
    assert_eq!(learn(ArdRvm { rvm: linear, ..ArdRvm::default() }), Error::NoWidth);
    let blocks = LengthScales::Blocks(vec![2, 3]);
    let error = learn(ArdRvm { length_scales: blocks, ..ArdRvm::default() });
    assert_eq!(error, Error::Shape { what: "inputs of all blocks", expected: 6, found: 5 });
    let error = learn(ArdRvm { rounds: 0, ..ArdRvm::default() });
    assert!(matches!(error, Error::Parameter { name: "max_iterations", .. }));
}
