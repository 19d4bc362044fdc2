//! Fitting and predicting at the size of the hand problem: 837 samples, 90 inputs, 24 targets.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use faer::Mat;
use phalanx_rvm::{
    AgarwalTriggs, Bandwidth, Kernel, KernelRidge, OrthogonalLeastSquares, Regressor,
    RelevanceVectorMachine, Scratch, Stop,
};
use rand_core::Rng;
use rand_pcg::Pcg64Mcg;

const SAMPLES: usize = 837;
const INPUTS: usize = 90;
const TARGETS: usize = 24;
/// Directions along which the samples really vary.
const LATENT: usize = 7;

/// Histogram-like inputs and angle-like targets, both smooth functions of a few latent numbers.
fn data() -> (Mat<f64>, Mat<f64>) {
    let mut random = Pcg64Mcg::new(837);
    let mut uniform = |rows, columns| {
        Mat::<f64>::from_fn(rows, columns, |_, _| {
            2.0 * f64::from(random.next_u32()) / f64::from(u32::MAX) - 1.0
        })
    };
    let latent = uniform(LATENT, SAMPLES);
    let (votes, straight, bent) =
        (uniform(INPUTS, LATENT), uniform(TARGETS, LATENT), uniform(TARGETS, LATENT));
    let noise = uniform(INPUTS, SAMPLES);
    let inputs = &votes * &latent;
    let x = Mat::from_fn(INPUTS, SAMPLES, |i, t| (inputs[(i, t)] + 0.2 * noise[(i, t)]).exp());
    let (along, across) = (&straight * &latent, &bent * &latent);
    let y = Mat::from_fn(TARGETS, SAMPLES, |j, t| {
        30.0 + 20.0 * along[(j, t)] + 5.0 * across[(j, t)].sin().powi(2)
    });
    (x, y)
}

fn fits(c: &mut Criterion) {
    let (x, y) = data();
    let (x, y) = (x.as_ref(), y.as_ref());
    let gaussian = Kernel::Gaussian(Bandwidth::Relative(0.3));
    let mut group = c.benchmark_group("fit 837x90 to 24");
    group.sample_size(10);
    for (name, kernel) in [("linear", Kernel::Linear), ("gaussian", gaussian)] {
        let bridges = AgarwalTriggs { kernel, stop: Stop::Count(40), ..AgarwalTriggs::default() };
        group.bench_function(format!("bridges {name} to 40"), |b| {
            b.iter(|| bridges.fit(black_box(x), y).unwrap());
        });
    }
    let forward =
        OrthogonalLeastSquares { kernel: gaussian, count: 40, ..OrthogonalLeastSquares::default() };
    group.bench_function("forward gaussian to 40", |b| {
        b.iter(|| forward.fit(black_box(x), y).unwrap());
    });
    let tipping =
        RelevanceVectorMachine { kernel: Kernel::Linear, ..RelevanceVectorMachine::default() };
    group.bench_function("Tipping linear", |b| {
        b.iter(|| tipping.fit(black_box(x), y).unwrap());
    });
    let kernel_ridge = KernelRidge::default();
    group.bench_function("kernel ridge, 7 lambdas", |b| {
        b.iter(|| kernel_ridge.fit(black_box(x), y).unwrap());
    });
    group.finish();
}

fn predictions(c: &mut Criterion) {
    let (x, y) = data();
    let features = x.as_ref().subrows(0, 32);
    let kernel = Kernel::Gaussian(Bandwidth::Relative(0.3));
    let forward = OrthogonalLeastSquares { kernel, count: 38, ..OrthogonalLeastSquares::default() };
    let sparse = forward.fit(features, y.as_ref()).unwrap().model;
    let dense = KernelRidge::default().fit(x.as_ref(), y.as_ref()).unwrap().model;
    let mut scratch = Scratch::default();
    let (mut mean, mut std) = ([0.0; TARGETS], [0.0; TARGETS]);
    for (name, model) in [("38 centres of 32", sparse), ("837 centres of 90", dense)] {
        let sample: Vec<f64> = x.col(400).iter().copied().take(model.inputs()).collect();
        let mut group = c.benchmark_group(format!("predict 24 from {name}"));
        group.bench_function("mean", |b| {
            b.iter(|| {
                model.predict_mean_into(black_box(&sample), &mut scratch, &mut mean).unwrap();
            });
        });
        group.bench_function("mean and deviation", |b| {
            b.iter(|| {
                model.predict_into(black_box(&sample), &mut scratch, &mut mean, &mut std).unwrap();
            });
        });
    }
}

criterion_group!(benches, fits, predictions);
criterion_main!(benches);
