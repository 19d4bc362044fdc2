//! Sums over samples that stream by: the same bits in any order, and the same regression as with
//! all samples in memory.

use std::ops::Range;

use faer::{Mat, MatRef};
use phalanx_rvm::{
    AgarwalTriggs, Bandwidth, BasisSpec, Error, Fit, Kernel, OrthogonalLeastSquares, PilotSample,
    Regressor, Result, Ridge, Stop, SufficientStatistics, SufficientStatisticsParts,
    TwoStageSelection, random_subset,
};
use proptest::prelude::*;

use crate::problems::{GAUSSIAN, Source, close, smooth};
use crate::property;

/// All samples as the pilot: then sums and memory have the same columns.
pub(crate) fn whole(x: MatRef<'_, f64>, y: MatRef<'_, f64>, kernel: Kernel) -> Result<BasisSpec> {
    let samples: Vec<usize> = (0..x.ncols()).collect();
    BasisSpec::new(&PilotSample { x, y, samples: &samples }, kernel)
}

pub(crate) fn summed(
    columns: &BasisSpec,
    x: MatRef<'_, f64>,
    y: MatRef<'_, f64>,
) -> Result<SufficientStatistics> {
    let mut sums = SufficientStatistics::new(columns);
    sums.add(columns, x, y)?;
    Ok(sums)
}

/// Samples of one call.
const CALL: usize = 700;
/// Seed of the pilot.
const PILOT_SEED: u64 = 1;

/// Adds `calls` of the stream, each cut into a block of 512 and a rest.
fn add(
    columns: &BasisSpec,
    x: &Mat<f64>,
    y: &Mat<f64>,
    calls: Range<usize>,
) -> SufficientStatistics {
    let mut sums = SufficientStatistics::new(columns);
    for call in calls {
        let (start, width) = (call * CALL, CALL.min(x.ncols() - call * CALL));
        sums.add(columns, x.subcols(start, width), y.subcols(start, width)).unwrap();
    }
    sums
}

/// A tenth of the samples as the pilot.
fn pilot_columns(x: &Mat<f64>, y: &Mat<f64>, kernel: Kernel) -> BasisSpec {
    let samples = random_subset(x.ncols(), x.ncols().div_ceil(10), PILOT_SEED);
    let pick = |from: &Mat<f64>| crate::problems::columns(from.as_ref(), &samples);
    let (x, y) = (pick(x), pick(y));
    BasisSpec::new(&PilotSample { x: x.as_ref(), y: y.as_ref(), samples: &samples }, kernel)
        .unwrap()
}

#[test]
fn shards_in_any_order_at_any_number_of_threads_have_the_bits_of_one_run() {
    let (x, y) = smooth(3, 6, 3, 8 * CALL - 100);
    for kernel in [Kernel::Linear, GAUSSIAN] {
        let columns = pilot_columns(&x, &y, kernel);
        let one = add(&columns, &x, &y, 0..8).into_parts();
        for threads in [1, 2, 8] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let shards: [SufficientStatistics; 4] =
                pool.install(|| [0, 1, 2, 3].map(|i| add(&columns, &x, &y, 2 * i..2 * i + 2)));
            for order in [[0, 1, 2, 3], [2, 0, 3, 1], [3, 2, 1, 0]] {
                let mut merged = SufficientStatistics::new(&columns);
                for shard in order {
                    merged.merge(&shards[shard]).unwrap();
                }
                assert_eq!(merged.into_parts(), one, "{kernel:?} {threads} {order:?}");
            }
        }
        #[cfg(feature = "serde")]
        {
            let sums = SufficientStatistics::from_parts(one).unwrap();
            let bytes = postcard::to_stdvec(&sums).unwrap();
            assert_eq!(postcard::from_bytes::<SufficientStatistics>(&bytes).unwrap(), sums);
        }
    }
}

/// A fitter in memory, and on sums.
type Both = (
    &'static str,
    Kernel,
    fn(MatRef<'_, f64>, MatRef<'_, f64>) -> Result<Fit>,
    fn(&BasisSpec, &SufficientStatistics) -> Result<Fit>,
);

fn ridge() -> Ridge {
    Ridge { kernel: GAUSSIAN, lambda: 0.1 }
}

fn bridges(kernel: Kernel) -> AgarwalTriggs {
    AgarwalTriggs { kernel, stop: Stop::Count(4), ..AgarwalTriggs::default() }
}

fn forward() -> OrthogonalLeastSquares {
    OrthogonalLeastSquares { kernel: GAUSSIAN, count: 5, lambda: 0.01, sweeps: 3 }
}

const BOTH: [Both; 4] = [
    ("ridge", GAUSSIAN, |x, y| ridge().fit(x, y), |c, s| ridge().fit_sums(c, s)),
    (
        "bridges, linear",
        Kernel::Linear,
        |x, y| bridges(Kernel::Linear).fit(x, y),
        |c, s| bridges(Kernel::Linear).fit_sums(c, s),
    ),
    (
        "bridges, Gaussian",
        GAUSSIAN,
        |x, y| bridges(GAUSSIAN).fit(x, y),
        |c, s| bridges(GAUSSIAN).fit_sums(c, s),
    ),
    ("forward", GAUSSIAN, |x, y| forward().fit(x, y), |c, s| forward().fit_sums(c, s)),
];

fn assert_same(name: &str, memory: &Fit, stream: &Fit, x: &Mat<f64>) {
    assert_eq!(memory.model.selected_features(), stream.model.selected_features(), "{name}");
    assert_eq!(memory.model.kept_samples(), stream.model.kept_samples(), "{name}");
    let (mean, std) = memory.model.predict_with_std(x.as_ref()).unwrap();
    let (streamed, streamed_std) = stream.model.predict_with_std(x.as_ref()).unwrap();
    assert!(close(streamed.as_ref(), mean.as_ref(), 1e-8), "{name}");
    assert!(close(streamed_std.as_ref(), std.as_ref(), 1e-6), "{name}");
}

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn sums_give_the_fit_of_all_samples_in_memory(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 6, 3, 60);
        for (name, kernel, fit, fit_sums) in BOTH {
            let columns = whole(x.as_ref(), y.as_ref(), kernel)?;
            let sums = summed(&columns, x.as_ref(), y.as_ref())?;
            let memory = fit(x.as_ref(), y.as_ref())?;
            assert_same(name, &memory, &fit_sums(&columns, &sums)?, &x);
        }
    }

    #[test]
    fn two_passes_are_the_cascade(seed in any::<u64>()) {
        let (x, y) = smooth(seed, 6, 3, 60);
        let cascade = TwoStageSelection {
            features: Stop::Count(3),
            samples: Stop::Count(5),
            ..TwoStageSelection::default()
        };
        let samples: Vec<usize> = (0..60).collect();
        let pilot = PilotSample { x: x.as_ref(), y: y.as_ref(), samples: &samples };
        let linear = BasisSpec::new(&pilot, Kernel::Linear)?;
        let first = cascade.fit_features(&linear, &summed(&linear, x.as_ref(), y.as_ref())?)?;
        let kernel = Kernel::Gaussian(cascade.bandwidth);
        let gaussian = BasisSpec::over(&pilot, kernel, first.model.selected_features())?;
        let sums = summed(&gaussian, x.as_ref(), y.as_ref())?;
        let fit = cascade.fit_samples(first, &gaussian, &sums)?;
        prop_assert_eq!(fit.report.traces.len(), 2);
        assert_same("cascade", &cascade.fit(x.as_ref(), y.as_ref())?, &fit, &x);
    }

    /// Σ ab of each two columns, one product after the other, on a stream that the pilot is only
    /// a part of.
    #[test]
    fn sums_are_those_of_all_products(seed in any::<u64>(), n in 1..1200_usize) {
        let (x, y) = smooth(seed, 4, 2, 1200);
        let (k, m, p) = (4, 2, 30);
        let samples: Vec<usize> = (0..p).collect();
        let (px, py) = (x.as_ref().subcols(0, p), y.as_ref().subcols(0, p));
        let kernel = Kernel::Gaussian(Bandwidth::Gamma(0.1));
        let columns = BasisSpec::new(&PilotSample { x: px, y: py, samples: &samples }, kernel)?;
        let scale = |from: MatRef<'_, f64>, of: MatRef<'_, f64>| {
            phalanx_rvm::StandardScaler::fit(of).and_then(|s| s.apply(from))
        };
        let (z, t) = (scale(x.as_ref(), px)?, scale(y.as_ref(), py)?);
        let phi = |i: usize, c: usize| -> f64 {
            let squared: f64 = (0..k).map(|f| (z[(f, i)] - z[(f, c)]).powi(2)).sum();
            (-0.1 * squared).exp()
        };
        // Where the columns were moved to before they were summed shows only here.
        let origin = |c: usize| {
            let mean = (0..p).map(|i| phi(i, c)).sum::<f64>() / p as f64;
            (mean * 1_048_576.0).round() / 1_048_576.0
        };
        let row = |i: usize| -> Vec<f64> {
            (0..p).map(|c| phi(i, c) - origin(c)).chain((0..m).map(|j| t[(j, i)])).chain([1.0]).collect()
        };
        let rows: Vec<Vec<f64>> = (0..n).map(row).collect();
        let sums = summed(&columns, x.as_ref().subcols(0, n), y.as_ref().subcols(0, n))?;
        prop_assert_eq!(sums.samples(), n);
        let pairs = (0..=p + m).flat_map(|b| (b..=p + m).map(move |a| (a, b)));
        prop_assert_eq!(sums.parts().packed.len(), pairs.clone().count());
        for ((a, b), &units) in pairs.zip(&sums.parts().packed) {
            let expected: f64 = rows.iter().map(|row| row[a] * row[b]).sum();
            let found = units as f64 / 2_f64.powi(64);
            prop_assert!((found - expected).abs() < 1e-9, "{a} {b}: {found} {expected}");
        }
    }

    #[test]
    fn hostile_parts_are_refused_or_solved(
        place in any::<prop::sample::Index>(),
        value in any::<i128>(),
        shift in 0..127_u32,
    ) {
        let (x, y) = smooth(5, 4, 2, 20);
        for (_, kernel, _, fit) in BOTH {
            let columns = whole(x.as_ref(), y.as_ref(), kernel)?;
            let mut parts = summed(&columns, x.as_ref(), y.as_ref())?.into_parts();
            let place = place.index(parts.packed.len());
            parts.packed[place] = value >> shift;
            if let Ok(sums) = SufficientStatistics::from_parts(parts) {
                // Whether it can be solved is its own business; that it returns is ours.
                let _ = fit(&columns, &sums);
            }
        }
    }
}

/// A change to the parts of sums.
type Damage = fn(&mut SufficientStatisticsParts);

#[test]
fn parts_that_do_not_fit_are_named() {
    let (x, y) = smooth(4, 5, 3, 30);
    let columns = whole(x.as_ref(), y.as_ref(), Kernel::Linear).unwrap();
    let sums = summed(&columns, x.as_ref(), y.as_ref()).unwrap();
    let damages: [(&str, Damage); 9] = [
        ("outputs", |p| p.outputs = 0),
        ("packed", |p| p.size = 6),
        ("packed", |p| p.size = usize::MAX),
        ("packed", |p| p.outputs = usize::MAX / 2),
        ("packed", |p| p.packed.clear()),
        ("packed", |p| *p.packed.last_mut().unwrap() = -1 << 64),
        ("packed", |p| *p.packed.last_mut().unwrap() += 1),
        ("packed", |p| *p.packed.last_mut().unwrap() = i128::MAX),
        ("packed", |p| p.packed[0] = 1 << 110),
    ];
    for (expected, damage) in damages {
        let mut parts = sums.clone().into_parts();
        damage(&mut parts);
        match SufficientStatistics::from_parts(parts) {
            Err(Error::SufficientStatisticsParts { field, .. }) => assert_eq!(field, expected),
            other => panic!("{expected}: {other:?}"),
        }
    }
}

/// Parts from outside may claim other counts with as many numbers, under the same fingerprint.
#[test]
fn sums_of_other_counts_belong_to_no_columns() {
    let (x, y) = smooth(4, 5, 3, 30);
    let columns = whole(x.as_ref(), y.as_ref(), Kernel::Linear).unwrap();
    let own = summed(&columns, x.as_ref(), y.as_ref()).unwrap();
    let SufficientStatisticsParts { columns: fingerprint, size, outputs, packed } =
        own.clone().into_parts();
    let parts = SufficientStatisticsParts {
        columns: fingerprint,
        size: size + 1,
        outputs: outputs - 1,
        packed,
    };
    let mut claimed = SufficientStatistics::from_parts(parts).unwrap();
    let other = |result| matches!(result, Err(Error::OtherColumns { .. }));
    assert!(other(claimed.add(&columns, x.as_ref(), y.as_ref())));
    assert!(other(claimed.merge(&own)));
    assert!(other(Ridge::default().fit_sums(&columns, &claimed).map(|_| ())));
}

#[test]
fn samples_that_cannot_be_summed_are_named_and_change_nothing() {
    let (x, y) = smooth(4, 5, 3, 30);
    let columns = whole(x.as_ref(), y.as_ref(), GAUSSIAN).unwrap();
    let mut sums = summed(&columns, x.as_ref(), y.as_ref()).unwrap();
    let before = sums.clone();
    let (mut far, mut not_a_number) = (y.clone(), x.clone());
    far[(1, 7)] = 1e8;
    not_a_number[(2, 3)] = f64::NAN;
    let refused = sums.add(&columns, x.as_ref(), far.as_ref());
    assert_eq!(refused, Err(Error::FarFromPilot { what: "y", row: 1, column: 7, value: 1e8 }));
    let refused = sums.add(&columns, not_a_number.as_ref(), y.as_ref());
    assert!(matches!(refused, Err(Error::BadValue { what: "x", row: 2, column: 3, .. })));
    let short = y.as_ref().subcols(0, 29);
    assert!(matches!(sums.add(&columns, x.as_ref(), short), Err(Error::Shape { .. })));
    let other = whole(x.as_ref().subcols(0, 29), short, GAUSSIAN).unwrap();
    assert!(matches!(sums.add(&other, x.as_ref(), y.as_ref()), Err(Error::OtherColumns { .. })));
    assert!(matches!(
        sums.merge(&SufficientStatistics::new(&other)),
        Err(Error::OtherColumns { .. })
    ));
    assert_eq!(sums, before);
}

#[test]
fn a_target_that_only_the_pilot_knows_as_constant_is_named() {
    let (x, mut y) = smooth(4, 5, 3, 30);
    y.row_mut(1).fill(2.0);
    let columns = whole(x.as_ref(), y.as_ref(), Kernel::Linear).unwrap();
    y[(1, 4)] += 1e-9;
    let mut sums = summed(&columns, x.as_ref(), y.as_ref()).unwrap();
    y[(1, 4)] = 3.0;
    let refused = sums.add(&columns, x.as_ref(), y.as_ref());
    assert_eq!(refused, Err(Error::ConstantInPilot { what: "y", row: 1, column: 4, value: 3.0 }));
}

#[test]
fn more_samples_than_sums_can_hold_are_named() {
    let (x, y) = smooth(4, 2, 1, 30);
    let columns = whole(x.as_ref(), y.as_ref(), Kernel::Linear).unwrap();
    let mut parts = SufficientStatistics::new(&columns).into_parts();
    *parts.packed.last_mut().unwrap() = (1 << 30) << 64;
    let mut sums = SufficientStatistics::from_parts(parts).unwrap();
    let too_many = Error::TooManySamples { samples: (1 << 30) + 30, limit: 1 << 30 };
    assert_eq!(sums.add(&columns, x.as_ref(), y.as_ref()), Err(too_many.clone()));
    assert_eq!(sums.merge(&summed(&columns, x.as_ref(), y.as_ref()).unwrap()), Err(too_many));
}

#[test]
fn fitters_name_sums_that_are_not_theirs() {
    let (x, y) = smooth(4, 5, 3, 30);
    let linear = whole(x.as_ref(), y.as_ref(), Kernel::Linear).unwrap();
    let gaussian = whole(x.as_ref(), y.as_ref(), GAUSSIAN).unwrap();
    let sums = summed(&linear, x.as_ref(), y.as_ref()).unwrap();
    for (name, kernel, _, fit) in BOTH {
        let own = if kernel == Kernel::Linear { &linear } else { &gaussian };
        let other = if kernel == Kernel::Linear { &gaussian } else { &linear };
        assert!(matches!(fit(other, &sums), Err(Error::OtherKernel { .. })), "{name}");
        let empty = fit(own, &SufficientStatistics::new(own));
        assert!(matches!(empty, Err(Error::Empty { what: "sums", .. })), "{name}");
    }
    let refused = ridge().fit_sums(&gaussian, &sums);
    assert!(matches!(refused, Err(Error::OtherColumns { .. })));
    let cascade = TwoStageSelection { features: Stop::Count(2), ..TwoStageSelection::default() };
    let first = cascade.fit_features(&linear, &sums).unwrap();
    let refused = cascade.fit_samples(first, &gaussian, &SufficientStatistics::new(&gaussian));
    assert!(matches!(refused, Err(Error::NotSelected { .. })));
}

#[test]
fn features_must_ascend_and_be_there() {
    let (x, y) = smooth(4, 3, 1, 10);
    let samples: Vec<usize> = (0..10).collect();
    let pilot = PilotSample { x: x.as_ref(), y: y.as_ref(), samples: &samples };
    for (features, feature) in [(&[0, 3][..], 3), (&[1, 0], 0), (&[1, 1], 1)] {
        let refused = BasisSpec::over(&pilot, Kernel::Linear, features);
        assert_eq!(refused, Err(Error::Index { what: "features", index: feature, available: 3 }));
    }
    let short = PilotSample { samples: &samples[1..], ..pilot };
    assert!(matches!(BasisSpec::new(&short, GAUSSIAN), Err(Error::Shape { .. })));
}

#[test]
fn kept_samples_are_named_by_their_place_in_the_whole_set() {
    let mut source = Source::new(9);
    let (x, y) = (source.matrix(3, 400), source.matrix(2, 400));
    let columns = pilot_columns(&x, &y, GAUSSIAN);
    let sums = summed(&columns, x.as_ref(), y.as_ref()).unwrap();
    let model = forward().fit_sums(&columns, &sums).unwrap().model;
    assert_eq!(model.kept_samples().len(), 5);
    let pilot = random_subset(400, 40, PILOT_SEED);
    assert!(model.kept_samples().iter().all(|s| pilot.contains(s)));
    assert!(model.kept_samples().iter().any(|&s| s >= 40));
}
