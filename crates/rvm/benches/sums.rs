//! Adding to sums and solving them, at the width of the hand problem: 90 inputs, 28 targets.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use faer::Mat;
use phalanx_rvm::{
    AgarwalTriggs, Bandwidth, BasisSpec, Kernel, NystromRidge, OrthogonalLeastSquares, PilotSample,
    Stop, SufficientStatistics,
};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;

const COLUMNS: usize = 1000;
/// Samples of one block.
const BLOCK: usize = 512;
const INPUTS: usize = 90;
const TARGETS: usize = 28;
const WIDTH: Bandwidth = Bandwidth::Relative(0.3);

/// Histogram-like inputs, and targets that are smooth functions of them.
fn data(samples: usize) -> (Mat<f64>, Mat<f64>) {
    let mut random = Pcg64Mcg::new(28);
    let mut uniform = |rows, columns| {
        Mat::<f64>::from_fn(rows, columns, |_, _| {
            2.0 * f64::from(random.next_u32()) / f64::from(u32::MAX) - 1.0
        })
    };
    let x = uniform(INPUTS, samples);
    let along = uniform(TARGETS, INPUTS) * &x;
    let y = Mat::from_fn(TARGETS, samples, |j, t| along[(j, t)] + along[(j, t)].sin());
    (x, y)
}

fn sums(c: &mut Criterion) {
    let (x, y) = data(COLUMNS + 8 * BLOCK);
    let samples: Vec<usize> = (0..COLUMNS).collect();
    let (px, py) = (x.as_ref().subcols(0, COLUMNS), y.as_ref().subcols(0, COLUMNS));
    let pilot = PilotSample { x: px, y: py, samples: &samples };
    let kernel = Kernel::Gaussian(WIDTH);
    let columns = BasisSpec::new(&pilot, kernel).unwrap();
    let mut sums = SufficientStatistics::new(&columns);
    sums.add(&columns, x.as_ref(), y.as_ref()).unwrap();

    let mut group = c.benchmark_group("sums over 1000 Gaussians of 90 inputs");
    group.sample_size(10);
    let (bx, by) = (px.subcols(0, BLOCK), py.subcols(0, BLOCK));
    let mut more = SufficientStatistics::new(&columns);
    group.bench_function("add a block of 512", |b| {
        b.iter(|| more.add(&columns, black_box(bx), by).unwrap());
    });
    let nystrom = NystromRidge { bandwidth: WIDTH, ..NystromRidge::default() };
    group.bench_function("Nyström, 6 lambdas", |b| {
        b.iter(|| nystrom.fit_sums(&columns, black_box(&sums)).unwrap());
    });
    let forward = OrthogonalLeastSquares { kernel, count: 40, ..OrthogonalLeastSquares::default() };
    group.bench_function("forward to 40", |b| {
        b.iter(|| forward.fit_sums(&columns, black_box(&sums)).unwrap());
    });
    let bridges = AgarwalTriggs { kernel, stop: Stop::Count(40), ..AgarwalTriggs::default() };
    group.bench_function("bridges to 40", |b| {
        b.iter(|| bridges.fit_sums(&columns, black_box(&sums)).unwrap());
    });
    group.finish();
}

criterion_group!(benches, sums);
criterion_main!(benches);
