//! Ordered, periodic samples: as good as shuffled ones, whatever their number.

use faer::{Mat, MatRef};
use phalanx_rvm::{
    AgarwalTriggs, ArdRvm, Bandwidth, BasisSpec, Error, ExpectedGradientOuterProduct, FeatureBlock,
    GroupedRegressor, Kernel, KernelRidge, MlpTrainer, Model, MultiOutputRvm, NystromRidge,
    OrthogonalLeastSquares, PilotSample, Regressor, RelevanceVectorMachine, Result, Ridge, Stop,
    SufficientStatistics, TwoStageSelection, random_subset,
};

use crate::problems::{GAUSSIAN, Source, columns};

/// Samples of a cycle, and turns at which each row of a motion is seen.
const CYCLE: usize = 12;
const TURNS: usize = 7;
/// Gaussians, at most. A seventh of 1,000, 2,000 and 4,000 rows' samples are multiples of it, so that
/// every n-th of them has the same turn.
const CENTRES: usize = 100;

/// 12 samples a cycle, in order: the phase and a second input, and sin(2π·phase) + x₂.
fn cycles(samples: usize) -> (Mat<f64>, Mat<f64>) {
    let mut source = Source::new(11);
    let x = Mat::from_fn(2, samples, |i, t| match i {
        0 => (t % CYCLE) as f64 / CYCLE as f64,
        _ => source.uniform(),
    });
    let y = Mat::from_fn(1, samples, |_, t| (std::f64::consts::TAU * x[(0, t)]).sin() + x[(1, t)]);
    (x, y)
}

fn root_mean_square(difference: MatRef<'_, f64>) -> f64 {
    let (rows, columns) = difference.shape();
    (difference.squared_norm_l2() / (rows * columns) as f64).sqrt()
}

#[test]
fn nystrom_on_ordered_samples_is_as_good_as_on_shuffled_ones() {
    let (x, y) = cycles(1200);
    let order = Source::new(5).order(1200);
    let shuffled = [&x, &y].map(|all| columns(all.as_ref(), &order));
    let centres = random_subset(1200, CENTRES, 1);
    let error = |x: &Mat<f64>, y: &Mat<f64>| {
        let model = NystromRidge::default().fit_on(x.as_ref(), y.as_ref(), &centres).unwrap().model;
        root_mean_square((model.predict(x.as_ref()).unwrap() - y).as_ref())
    };
    let (ordered, shuffled) = (error(&x, &y), error(&shuffled[0], &shuffled[1]));
    assert!(ordered < 0.02 && shuffled < 0.02, "{ordered} {shuffled}");
}

/// A motion of two joints, 12 rows a cycle whose size drifts, each row at seven turns about an axis;
/// six mildly non-linear inputs; three targets: the joints and the turn.
fn motion(rows: usize) -> (Mat<f64>, Mat<f64>) {
    let y = Mat::from_fn(3, rows * TURNS, |j, t| {
        let row = t / TURNS;
        let phase = std::f64::consts::TAU * (row % CYCLE) as f64 / CYCLE as f64;
        let size = 0.7 + 0.3 * (row as f64 * 0.618).fract();
        match j {
            0 => size * phase.sin(),
            1 => size * phase.cos(),
            _ => (t % TURNS) as f64 / 3.0 - 1.0,
        }
    });
    let mix = Source::new(3).matrix(6, 3);
    let mixed = &mix * &y;
    let mut source = Source::new(4);
    let x = Mat::from_fn(6, y.ncols(), |i, t| {
        mixed[(i, t)] + (1.5 * mixed[(i, t)]).sin() + 0.05 * source.uniform()
    });
    (x, y)
}

/// Root mean squared error over all targets on rows that no fit has seen.
fn error(predict: impl Fn(MatRef<'_, f64>) -> Mat<f64>) -> f64 {
    let (x, y) = motion(4500);
    let unseen = 4100 * TURNS..4500 * TURNS;
    let (x, y) = (x.subcols(unseen.start, unseen.len()), y.subcols(unseen.start, unseen.len()));
    root_mean_square((predict(x) - y).as_ref())
}

fn of_model(model: &Model) -> f64 {
    error(|x| model.predict(x).unwrap())
}

/// Are errors the same, within noise, for numbers of rows that share a factor with the cycle and
/// the turns, and for their neighbours?
fn alike(pairs: &[(usize, usize)], error_of: impl Fn(&Mat<f64>, &Mat<f64>) -> f64) {
    for &(round, other) in pairs {
        let [round, other] = [round, other].map(|rows| {
            let (x, y) = motion(rows);
            error_of(&x, &y)
        });
        assert!(round < 0.35 && other < 0.35, "{round} {other}");
        // Another choice of centres changes this much; the targets lie within ±1.
        assert!((round - other).abs() < 0.25 * round.min(other) + 0.01, "{round} {other}");
    }
}

const ROWS: [(usize, usize); 3] = [(1000, 1001), (2000, 1999), (4000, 4003)];
/// The dense fitters take all samples and choose none; of 7,000 they would take minutes.
const FEW_ROWS: [(usize, usize); 1] = [(100, 101)];

fn pilot_columns(x: &Mat<f64>, y: &Mat<f64>, kernel: Kernel, features: &[usize]) -> BasisSpec {
    let samples = random_subset(x.ncols(), CENTRES, 1);
    let [pilot_x, pilot_y] = [x, y].map(|all| columns(all.as_ref(), &samples));
    let pilot = PilotSample { x: pilot_x.as_ref(), y: pilot_y.as_ref(), samples: &samples };
    BasisSpec::over(&pilot, kernel, features).unwrap()
}

fn summed(columns: &BasisSpec, x: &Mat<f64>, y: &Mat<f64>) -> SufficientStatistics {
    let mut sums = SufficientStatistics::new(columns);
    sums.add(columns, x.as_ref(), y.as_ref()).unwrap();
    sums
}

const ALL: [usize; 6] = [0, 1, 2, 3, 4, 5];

/// Fits sums over a random pilot's columns.
fn streamed(
    kernel: Kernel,
    fit: impl Fn(&BasisSpec, &SufficientStatistics) -> Result<phalanx_rvm::Fit>,
) {
    alike(&ROWS, |x, y| {
        let columns = pilot_columns(x, y, kernel, &ALL);
        of_model(&fit(&columns, &summed(&columns, x, y)).unwrap().model)
    });
}

#[test]
fn linear_ridge() {
    streamed(Kernel::Linear, |columns, sums| Ridge::default().fit_sums(columns, sums));
}

#[test]
fn ridge() {
    let ridge = Ridge { kernel: GAUSSIAN, lambda: 0.1 };
    streamed(GAUSSIAN, |columns, sums| ridge.fit_sums(columns, sums));
}

#[test]
fn bridges() {
    let bridges = AgarwalTriggs { stop: Stop::Count(30), ..AgarwalTriggs::default() };
    streamed(bridges.kernel, |columns, sums| bridges.fit_sums(columns, sums));
}

#[test]
fn forward_selection() {
    let forward = OrthogonalLeastSquares { count: 30, ..OrthogonalLeastSquares::default() };
    streamed(forward.kernel, |columns, sums| forward.fit_sums(columns, sums));
}

#[test]
fn multivariate_rvm() {
    let rvm = MultiOutputRvm { max_columns: Some(30), ..MultiOutputRvm::default() };
    streamed(rvm.kernel, |columns, sums| rvm.fit_sums(columns, sums));
}

#[test]
fn nystrom() {
    streamed(GAUSSIAN, |columns, sums| NystromRidge::default().fit_sums(columns, sums));
    alike(&ROWS, |x, y| {
        let centres = random_subset(x.ncols(), CENTRES, 1);
        of_model(&NystromRidge::default().fit_on(x.as_ref(), y.as_ref(), &centres).unwrap().model)
    });
}

#[test]
fn cascade() {
    let cascade = TwoStageSelection {
        features: Stop::Count(5),
        samples: Stop::Count(30),
        ..TwoStageSelection::default()
    };
    alike(&ROWS, |x, y| {
        let linear = pilot_columns(x, y, Kernel::Linear, &ALL);
        let first = cascade.fit_features(&linear, &summed(&linear, x, y)).unwrap();
        let kernel = Kernel::Gaussian(cascade.bandwidth);
        let gaussian = pilot_columns(x, y, kernel, first.model.selected_features());
        let sums = summed(&gaussian, x, y);
        of_model(&cascade.fit_samples(first, &gaussian, &sums).unwrap().model)
    });
}

#[test]
fn learnt_metric() {
    let regression = NystromRidge::default();
    let learning = ExpectedGradientOuterProduct {
        regression: regression.clone(),
        rounds: 1,
        centres: CENTRES,
        gradients: CENTRES,
        rank: 4,
    };
    let blocks = [FeatureBlock { inputs: 6, components: 6 }];
    alike(&ROWS, |x, y| {
        let groups = [vec![0, 1], vec![2]];
        let metric = learning.fit(x.as_ref(), y.as_ref(), &blocks, &groups).unwrap();
        let z = metric.projection.apply(x.as_ref()).unwrap();
        let centres = random_subset(x.ncols(), CENTRES, 1);
        let model = |group| {
            let (x, y) = (metric.part(group, z.as_ref()), metric.targets(group, y.as_ref()));
            regression.fit_on(x, y.as_ref(), &centres).unwrap().model
        };
        let projected =
            GroupedRegressor::from_parts(metric.clone(), vec![model(0), model(1)]).unwrap();
        error(|x| projected.predict_with_std(x).unwrap().0)
    });
}

#[test]
fn perceptron() {
    let fitter = MlpTrainer {
        hidden: vec![24],
        epochs: 6,
        batch: 64,
        dropout: 0.0,
        ..MlpTrainer::default()
    };
    alike(&ROWS, |x, y| {
        let network = fitter.fit(x.as_ref(), y.as_ref()).unwrap().model;
        error(|x| network.predict_with_std(x).unwrap().0)
    });
}

#[test]
fn kernel_ridge() {
    alike(&FEW_ROWS, |x, y| {
        of_model(&KernelRidge::default().fit(x.as_ref(), y.as_ref()).unwrap().model)
    });
}

#[test]
fn tipping() {
    let tipping = RelevanceVectorMachine { restarts: 0, ..RelevanceVectorMachine::default() };
    alike(&FEW_ROWS, |x, y| of_model(&tipping.fit(x.as_ref(), y.as_ref()).unwrap().model));
}

#[test]
fn learnt_widths() {
    let widths = ArdRvm { rounds: 3, ..ArdRvm::default() };
    alike(&FEW_ROWS, |x, y| of_model(&widths.fit(x.as_ref(), y.as_ref()).unwrap().model));
}

/// What a pilot of every n-th sample leads to.
#[test]
fn a_pilot_that_misses_what_varies_is_refused_by_name() {
    let (x, y) = motion(1000);
    let samples: Vec<usize> = (0..CENTRES).map(|k| k * x.ncols() / CENTRES).collect();
    let [pilot_x, pilot_y] = [&x, &y].map(|all| columns(all.as_ref(), &samples));
    let pilot = PilotSample { x: pilot_x.as_ref(), y: pilot_y.as_ref(), samples: &samples };
    let columns = BasisSpec::new(&pilot, Kernel::Gaussian(Bandwidth::Relative(1.0))).unwrap();
    let refused =
        SufficientStatistics::new(&columns).add(&columns, x.as_ref(), y.as_ref()).unwrap_err();
    assert!(matches!(refused, Error::ConstantInPilot { what: "y", row: 2, .. }), "{refused}");
    assert!(refused.to_string().contains("at random"), "{refused}");
}
