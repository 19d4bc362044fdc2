//! Input that is wrong or barely right: a named error, or a finite prediction.

use faer::Mat;
use phalanx_rvm::{
    AgarwalTriggs, ArdRvm, Bandwidth, Error, Kernel, KernelRidge, MultiOutputRvm,
    NystromRegularisation, NystromRidge, OrthogonalLeastSquares, ProblemSize, Regressor,
    Regularisation, RelevanceVectorMachine, Ridge, StandardScaler, Stop, TwoStageSelection,
};
use proptest::prelude::*;

use crate::problems::{FITTERS, Source, smooth};
use crate::property;

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn barely_right_data_give_finite_predictions(
        seed in any::<u64>(),
        k in 1..6_usize,
        m in 1..4_usize,
        n in 1..9_usize,
        levels in 1..4_u32,
        magnitude in -100..100_i32,
    ) {
        // Few levels: constant rows, repeated samples and exact dependence all occur.
        let mut source = Source::new(seed);
        let mut coarse = |rows| {
            let unit = 10_f64.powi(magnitude);
            let level = f64::from(levels);
            Mat::from_fn(rows, n, |_, _| unit * (level * source.uniform()).round())
        };
        let (x, y) = (coarse(k), coarse(m));
        for (name, fit) in FITTERS {
            let model = match fit(x.as_ref(), y.as_ref()) {
                Ok(fit) => fit.model,
                Err(Error::Count { .. }) if name == "orthogonal least squares" => continue,
                Err(error) => return Err(TestCaseError::fail(format!("{name}: {error}"))),
            };
            let (mean, std) = model.predict_with_std(x.as_ref())?;
            prop_assert!(mean.norm_max().is_finite(), "{name}");
            // Infinite where a target does not vary.
            prop_assert!(std.col_iter().all(|c| c.iter().all(|&v| v > 0.0)), "{name}");
        }
    }
}

#[test]
fn wrong_matrices_are_named() {
    let (x, y) = smooth(1, 3, 2, 10);
    for (name, fit) in FITTERS {
        let short = y.as_ref().subcols(0, 9);
        let mismatch = Error::Shape { what: "columns (samples) of y", expected: 10, found: 9 };
        assert_eq!(fit(x.as_ref(), short).unwrap_err(), mismatch, "{name}");
        let none = fit(x.as_ref().subcols(0, 0), y.as_ref().subcols(0, 0)).unwrap_err();
        assert_eq!(none, Error::Empty { what: "x", rows: 3, columns: 0 }, "{name}");
        for bad in [f64::NAN, f64::INFINITY, -1e200] {
            let mut holed = y.clone();
            holed[(1, 4)] = bad;
            let error = fit(x.as_ref(), holed.as_ref()).unwrap_err();
            assert!(
                matches!(error, Error::BadValue { what: "y", row: 1, column: 4, .. }),
                "{name}"
            );
            let mut holed = x.clone();
            holed[(2, 5)] = bad;
            let error = fit(holed.as_ref(), y.as_ref()).unwrap_err();
            assert!(
                matches!(error, Error::BadValue { what: "x", row: 2, column: 5, .. }),
                "{name}"
            );
            let model = fit(x.as_ref(), y.as_ref()).unwrap().model;
            match model.predict(holed.as_ref()) {
                Err(error) => {
                    let named = matches!(error, Error::BadValue { row: 2, column: 5, .. });
                    assert!(named, "{name}: {error}");
                }
                Ok(_) => assert!(!model.selected_features().contains(&2), "{name}"),
            }
        }
    }
}

#[test]
fn constant_targets_are_met_exactly_and_constant_inputs_ignored() {
    let (x, y) = smooth(2, 4, 3, 30);
    let x = Mat::from_fn(4, 30, |i, t| if i == 1 { 0.3 } else { x[(i, t)] });
    let y = Mat::from_fn(3, 30, |j, t| if j == 2 { 0.1 } else { y[(j, t)] });
    for (name, fit) in FITTERS {
        let model = fit(x.as_ref(), y.as_ref()).unwrap().model;
        assert!(!model.selected_features().contains(&1), "{name}");
        let (mean, std) = model.predict_with_std(x.as_ref()).unwrap();
        assert!(mean.row(2).iter().all(|&v| v == 0.1), "{name}");
        assert!(std.row(2).iter().all(|&v| v == f64::INFINITY), "{name}");
        assert!(std.row(0).iter().all(|&v| v > 0.0 && v.is_finite()), "{name}");
    }
}

#[test]
fn hyper_parameters_out_of_range_are_named() {
    let (x, y) = smooth(3, 4, 2, 12);
    let (x, y) = (x.as_ref(), y.as_ref());
    let bridges = AgarwalTriggs::default();
    let forward = OrthogonalLeastSquares::default();
    let tipping = RelevanceVectorMachine::default();
    let shared = MultiOutputRvm::default();
    let name = |result: phalanx_rvm::Result<phalanx_rvm::Fit>| match result.unwrap_err() {
        Error::Parameter { name, .. } => name,
        other => panic!("{other}"),
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(name(Ridge { lambda: bad, ..Ridge::default() }.fit(x, y)), "lambda");
        assert_eq!(name(AgarwalTriggs { nu: bad, ..bridges }.fit(x, y)), "nu");
        assert_eq!(name(AgarwalTriggs { lambda: bad, ..bridges }.fit(x, y)), "lambda");
        assert_eq!(name(AgarwalTriggs { tolerance: bad, ..bridges }.fit(x, y)), "tolerance");
        assert_eq!(
            name(TwoStageSelection { nu: bad, ..TwoStageSelection::default() }.fit(x, y)),
            "nu"
        );
        assert_eq!(name(OrthogonalLeastSquares { lambda: bad, ..forward }.fit(x, y)), "lambda");
        assert_eq!(
            name(RelevanceVectorMachine { tolerance: bad, ..tipping }.fit(x, y)),
            "tolerance"
        );
        assert_eq!(
            name(RelevanceVectorMachine { noise_floor: bad, ..tipping }.fit(x, y)),
            "noise_floor"
        );
        if bad != 0.0 {
            assert_eq!(
                name(RelevanceVectorMachine { min_evidence_gain: bad, ..tipping }.fit(x, y)),
                "min_evidence_gain"
            );
        }
        assert_eq!(name(MultiOutputRvm { tolerance: bad, ..shared }.fit(x, y)), "tolerance");
        assert_eq!(name(MultiOutputRvm { noise_floor: bad, ..shared }.fit(x, y)), "noise_floor");
        let lambda = Regularisation::Loocv(vec![1.0, bad]);
        assert_eq!(
            name(KernelRidge { regularisation: lambda, ..KernelRidge::default() }.fit(x, y)),
            "lambda"
        );
        let penalty = NystromRegularisation::Gcv(vec![1.0, bad]);
        assert_eq!(
            name(NystromRidge { regularisation: penalty, ..NystromRidge::default() }.fit(x, y)),
            "lambda"
        );
        let kernel = Kernel::Gaussian(Bandwidth::Relative(bad));
        assert_eq!(name(AgarwalTriggs { kernel, ..bridges }.fit(x, y)), "c");
    }
    let kernel = Kernel::Gaussian(Bandwidth::Gamma(0.0));
    assert_eq!(name(RelevanceVectorMachine { kernel, ..tipping }.fit(x, y)), "gamma");
    assert_eq!(
        name(AgarwalTriggs { stop: Stop::Threshold(-1.0), ..bridges }.fit(x, y)),
        "threshold"
    );
    assert_eq!(name(AgarwalTriggs { max_iterations: 0, ..bridges }.fit(x, y)), "max_iterations");
    assert_eq!(
        name(RelevanceVectorMachine { max_iterations: 0, ..tipping }.fit(x, y)),
        "max_iterations"
    );
    assert_eq!(name(MultiOutputRvm { max_columns: Some(0), ..shared }.fit(x, y)), "max_columns");
    let lambda = Regularisation::Loocv(Vec::new());
    let error =
        KernelRidge { regularisation: lambda, ..KernelRidge::default() }.fit(x, y).unwrap_err();
    assert!(matches!(error, Error::Empty { .. }));
    for asked in [0, 13] {
        let count = Error::Count { requested: asked, available: 12 };
        let stop = Stop::Count(asked);
        assert_eq!(AgarwalTriggs { stop, ..bridges }.fit(x, y).unwrap_err(), count);
        assert_eq!(
            OrthogonalLeastSquares { count: asked, ..forward }.fit(x, y).unwrap_err(),
            count
        );
    }
    let on = |centres: &[usize]| NystromRidge::default().fit_on(x, y, centres).unwrap_err();
    assert_eq!(on(&[]), Error::Count { requested: 0, available: 12 });
    for (centres, index) in [([3, 3], 3), ([4, 2], 2), ([2, 12], 12)] {
        assert_eq!(on(&centres), Error::Index { what: "centres", index, available: 12 });
    }
    let cascade = TwoStageSelection { features: Stop::Count(5), ..TwoStageSelection::default() };
    assert_eq!(cascade.fit(x, y).unwrap_err(), Error::Count { requested: 5, available: 4 });
}

/// What can be refused before there are data is refused as the fit itself would.
#[test]
fn sizes_are_refused_beforehand() {
    let samples = 10_001;
    let x = Mat::from_fn(1, samples, |_, t| t as f64);
    let size = ProblemSize::of(x.as_ref(), x.as_ref());
    let limit = 10_000;
    let too_many = Err(Error::TooManyColumns { columns: samples, limit });
    assert_eq!(KernelRidge::default().check(size), too_many);
    assert_eq!(RelevanceVectorMachine::default().check(size), too_many);
    assert_eq!(MultiOutputRvm::default().check(size), too_many);
    assert_eq!(ArdRvm::default().check(size), too_many);
    assert_eq!(AgarwalTriggs::default().check(size), too_many);
    assert_eq!(OrthogonalLeastSquares::default().check(size), too_many);
    assert_eq!(TwoStageSelection::default().check(size), too_many);
    let found = KernelRidge::default().fit(x.as_ref(), x.as_ref());
    assert_eq!(found.map(drop), too_many);
    assert_eq!(NystromRidge::default().check(size), Ok(()));
    assert_eq!(Ridge::default().check(size), Ok(()));
    let wide = ProblemSize { samples: 3, inputs: 12_000, outputs: 1 };
    let too_many = Err(Error::TooManyColumns { columns: 12_000, limit });
    assert_eq!(Ridge::default().check(wide), too_many);
    assert_eq!(TwoStageSelection::default().check(wide), too_many);
    assert_eq!(KernelRidge::default().check(wide), Ok(()));
    let few = OrthogonalLeastSquares { count: 4, ..OrthogonalLeastSquares::default() };
    assert_eq!(few.check(wide), Err(Error::Count { requested: 4, available: 3 }));
    let ridge = Ridge { lambda: -1.0, ..Ridge::default() };
    assert!(matches!(ridge.check(size), Err(Error::Parameter { name: "lambda", .. })));
}

#[test]
fn too_few_steps_are_reported_and_not_refused() {
    let (x, y) = smooth(3, 4, 2, 12);
    let (x, y) = (x.as_ref(), y.as_ref());
    let bridges =
        AgarwalTriggs { max_iterations: 1, ..AgarwalTriggs::default() }.fit(x, y).unwrap();
    assert!(!bridges.report.converged && bridges.report.iterations == 1);
    assert_eq!(bridges.report.penalty, Some(AgarwalTriggs::default().nu));
    let tipping = RelevanceVectorMachine { max_iterations: 1, ..RelevanceVectorMachine::default() }
        .fit(x, y)
        .unwrap();
    assert!(!tipping.report.converged && tipping.report.iterations == 2);
    let shared = MultiOutputRvm { max_iterations: 1, ..MultiOutputRvm::default() };
    let shared = shared.fit(x, y).unwrap();
    assert!(!shared.report.converged && shared.report.iterations == 1);
}

#[test]
fn a_standardiser_is_undone_by_its_inverse() {
    let (x, _) = smooth(8, 3, 1, 20);
    let standardiser = StandardScaler::fit(x.as_ref()).unwrap();
    let back = standardiser.invert(standardiser.apply(x.as_ref()).unwrap().as_ref()).unwrap();
    assert!((&back - &x).norm_max() < 1e-15);
    let parts =
        StandardScaler::from_parts(standardiser.mean().to_vec(), standardiser.scale().to_vec());
    assert_eq!(parts.unwrap(), standardiser);
    assert!(StandardScaler::from_parts(vec![0.0], vec![-1.0]).is_err());
}
