//! Learnt distances: what they find, and what is refused.

use phalanx_rvm::faer::{Mat, MatRef};
use phalanx_rvm::{
    AffineMap, AffineMapParts, Bandwidth, BasisSpec, Error, ExpectedGradientOuterProduct,
    FeatureBlock, GroupedRegressor, LearnedMetric, NystromRegularisation, NystromRidge,
    PilotSample, PredictiveDeviation, Regressor, Scratch, SufficientStatistics, TargetGroup,
    random_subset,
};
use proptest::prelude::*;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::property;

/// Uniform in −1 … 1.
fn uniform(rows: usize, columns: usize, seed: u64) -> Mat<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    Mat::from_fn(rows, columns, |_, _| {
        f64::from(random.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0
    })
}

const INPUTS: usize = 8;

/// Two targets, the first of input 0 alone, the second of inputs 5 and 6.
fn targets(x: MatRef<'_, f64>) -> Mat<f64> {
    Mat::from_fn(2, x.ncols(), |j, i| match j {
        0 => (4.0 * x[(0, i)]).sin(),
        _ => (3.0 * (x[(5, i)] - x[(6, i)])).cos(),
    })
}

fn learner(rank: usize, rounds: usize) -> ExpectedGradientOuterProduct {
    let penalty = NystromRegularisation::Gcv(vec![1e-4, 1e-3, 1e-2, 0.1]);
    let regression = NystromRidge {
        bandwidth: Bandwidth::Relative(3.0),
        deviation: PredictiveDeviation::Gcv,
        regularisation: penalty,
    };
    ExpectedGradientOuterProduct { regression, rounds, centres: 200, gradients: 100, rank }
}

fn blocks() -> [FeatureBlock; 2] {
    [FeatureBlock { inputs: 3, components: 3 }, FeatureBlock { inputs: 5, components: 5 }]
}

fn learnt(rounds: usize) -> (Mat<f64>, Mat<f64>, LearnedMetric) {
    let x = uniform(INPUTS, 400, 1);
    let y = targets(x.as_ref());
    let metric =
        learner(3, rounds).fit(x.as_ref(), y.as_ref(), &blocks(), &[vec![0], vec![1]]).unwrap();
    (x, y, metric)
}

/// How far each group's numbers move with each input.
fn reach(metric: &LearnedMetric, group: usize) -> Vec<f64> {
    let parts = metric.projection.parts();
    let d = parts.offset.len();
    let matrix = Mat::from_fn(d, INPUTS, |row, k| f64::from(parts.matrix[k * d + row]));
    let own = metric.part(group, matrix.as_ref());
    own.col_iter().map(|column| column.norm_l2()).collect()
}

#[test]
fn a_distance_counts_what_its_targets_depend_on() {
    for rounds in 1..=3 {
        let (_, _, metric) = learnt(rounds);
        for (group, matter) in [(0, &[0][..]), (1, &[5, 6])] {
            let reach = reach(&metric, group);
            let least = matter.iter().map(|&k| reach[k]).fold(f64::INFINITY, f64::min);
            let others = (0..INPUTS).filter(|k| !matter.contains(k)).map(|k| reach[k]);
            let most = others.fold(0.0, f64::max);
            assert!(least > 1.5 * most, "round {rounds}, group {group}: {reach:?}");
        }
    }
}

/// Fits every group of a metric by way of sums.
fn fit(metric: &LearnedMetric, x: MatRef<'_, f64>, y: MatRef<'_, f64>) -> GroupedRegressor {
    let z = metric.projection.apply(x).unwrap();
    let samples: Vec<usize> = (0..150).collect();
    let model = |group: usize| {
        let (x, y) = (metric.part(group, z.as_ref()), metric.targets(group, y));
        let y_pilot = y.subcols(0, 150);
        let pilot = PilotSample { x: x.subcols(0, 150), y: y_pilot, samples: &samples };
        let regression = learner(3, 1).regression;
        let columns = BasisSpec::in_proportion(&pilot, regression.bandwidth).unwrap();
        let mut sums = SufficientStatistics::new(&columns);
        sums.add(&columns, x, y.as_ref()).unwrap();
        regression.fit_sums(&columns, &sums).unwrap().model
    };
    let models = (0..metric.groups.len()).map(model).collect();
    GroupedRegressor::from_parts(metric.clone(), models).unwrap()
}

/// Mean squared errors of the two targets on new inputs, and the deviations announced.
fn errors(projected: &GroupedRegressor) -> [[f64; 2]; 2] {
    let x = uniform(INPUTS, 200, 99);
    let y = targets(x.as_ref());
    let mut scratch = Scratch::default();
    let (mut squared, mut announced) = ([0.0; 2], [0.0; 2]);
    for i in 0..x.ncols() {
        let (mut mean, mut std) = ([f64::NAN; 2], [f64::NAN; 2]);
        projected.predict_into(x.col_as_slice(i), &mut scratch, &mut mean, &mut std).unwrap();
        for j in 0..2 {
            squared[j] += (mean[j] - y[(j, i)]).powi(2) / 200.0;
            announced[j] += std[j].powi(2) / 200.0;
        }
    }
    [squared, announced]
}

#[test]
fn regression_in_it_is_better_than_with_all_inputs_alike() {
    let (x, y, metric) = learnt(2);
    let centres = random_subset(x.ncols(), 150, 1);
    let alike = learner(3, 1).regression.fit_on(x.as_ref(), y.as_ref(), &centres).unwrap().model;
    let new = uniform(INPUTS, 200, 99);
    let missed = alike.predict(new.as_ref()).unwrap() - targets(new.as_ref());
    let plain = missed.row(1).iter().map(|error| error * error).sum::<f64>() / 200.0;
    let [squared, announced] = errors(&fit(&metric, x.as_ref(), y.as_ref()));
    assert!(squared[1] < 0.5 * plain, "{} {plain}", squared[1]);
    // Cross-validation knows about how far off new samples are.
    for j in 0..2 {
        assert!((0.2..5.0).contains(&(announced[j] / squared[j])), "{announced:?} {squared:?}");
    }
}

#[test]
fn any_number_of_threads_learns_the_same() {
    let threads = |count| rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
    let [one, two] = [1, 2].map(|count| threads(count).install(|| learnt(2).2));
    assert_eq!(one, two);
}

#[test]
fn targets_that_do_not_vary_read_nothing() {
    let x = uniform(INPUTS, 60, 4);
    let y = Mat::from_fn(1, 60, |_, _| 2.5);
    let metric = learner(3, 2).fit(x.as_ref(), y.as_ref(), &blocks(), &[vec![0]]).unwrap();
    assert_eq!(metric.groups, [TargetGroup { outputs: vec![0], rank: 0 }]);
}

#[test]
fn what_cannot_be_learnt_from_is_refused_by_name() {
    let x = uniform(INPUTS, 60, 4);
    let y = targets(x.as_ref());
    let learn =
        |learner: ExpectedGradientOuterProduct, blocks: &[FeatureBlock], groups: &[Vec<usize>]| {
            learner.fit(x.as_ref(), y.as_ref(), blocks, groups).unwrap_err()
        };
    let short = [FeatureBlock { inputs: 7, components: 2 }];
    assert!(matches!(
        learn(learner(3, 1), &short, &[vec![0]]),
        Error::Shape { expected: 8, found: 7, .. }
    ));
    assert_eq!(
        learn(learner(3, 1), &blocks(), &[vec![2]]),
        Error::Index { what: "groups", index: 2, available: 2 }
    );
    assert!(matches!(learn(learner(0, 1), &blocks(), &[vec![0]]), Error::Count { .. }));
    assert!(matches!(learn(learner(3, 0), &blocks(), &[vec![0]]), Error::Count { .. }));
    let none = ExpectedGradientOuterProduct { centres: 0, ..learner(3, 1) };
    assert!(matches!(learn(none, &blocks(), &[vec![0]]), Error::Count { .. }));
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let (x, y, metric) = learnt(1);
    let good = fit(&metric, x.as_ref(), y.as_ref());
    let models = good.models().to_vec();
    assert!(GroupedRegressor::from_parts(metric.clone(), models.clone()).is_ok());
    assert!(GroupedRegressor::from_parts(metric.clone(), models[..1].to_vec()).is_err());
    let spoils: [fn(&mut LearnedMetric); 4] = [
        |metric| metric.groups[0].rank = 2,
        |metric| metric.groups[0].rank = usize::MAX,
        |metric| metric.groups[1].outputs = vec![0],
        |metric| metric.groups[1].outputs = vec![1, 2],
    ];
    for (k, spoil) in spoils.into_iter().enumerate() {
        let mut spoilt = metric.clone();
        spoil(&mut spoilt);
        assert!(GroupedRegressor::from_parts(spoilt, models.clone()).is_err(), "spoil {k}");
    }
    let parts = AffineMapParts { inputs: 2, matrix: vec![1.0; 6], offset: vec![0.0; 3] };
    assert!(AffineMap::from_parts(parts.clone()).is_ok());
    let unusable = AffineMapParts { matrix: vec![f32::NAN; 6], ..parts.clone() };
    let longer = AffineMapParts { inputs: usize::MAX, ..parts };
    for bad in [unusable, longer] {
        assert!(matches!(AffineMap::from_parts(bad), Err(Error::Parts { .. })));
    }
}

proptest! {
    #![proptest_config(property::cases(64))]

    #[test]
    fn a_projection_is_the_slow_one(inputs in 1..40_usize, outputs in 1..20_usize, seed: u64) {
        let matrix = uniform(outputs, inputs, seed);
        let (offset, x) = (uniform(outputs, 1, seed ^ 1), uniform(inputs, 3, seed ^ 2));
        let single = |of: &Mat<f64>| -> Vec<f32> {
            of.col_iter().flat_map(|c| c.iter().map(|&v| v as f32).collect::<Vec<_>>()).collect()
        };
        let parts =
            AffineMapParts { inputs, matrix: single(&matrix), offset: single(&offset) };
        let z = AffineMap::from_parts(parts).unwrap().apply(x.as_ref()).unwrap();
        for i in 0..3 {
            for row in 0..outputs {
                let slow: f64 = (0..inputs).map(|k| matrix[(row, k)] * x[(k, i)]).sum();
                prop_assert!((z[(row, i)] - slow - offset[(row, 0)]).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn inputs_that_are_no_numbers_are_refused(value in prop_oneof![
        Just(f64::NAN), Just(f64::INFINITY), Just(1e200)
    ]) {
        let parts = AffineMapParts { inputs: 2, matrix: vec![1.0; 2], offset: vec![0.0] };
        let projection = AffineMap::from_parts(parts).unwrap();
        let refused = projection.apply_into(&[0.0, value], &mut Vec::new(), &mut Vec::new());
        let named = matches!(refused, Err(Error::BadValue { row: 1, .. }));
        prop_assert!(named);
    }
}
