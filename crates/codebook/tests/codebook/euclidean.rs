//! K-means, votes and residuals by squared Euclidean distances, whole and in batches.

use phalanx_codebook::{
    Codebook, Encoder, Error, FixedRadius, KMeans, Metric, MiniBatch, Scratch, SoftAssignment,
    SoftHistogram, Vlad, squared_euclidean,
};
use proptest::prelude::*;

use crate::histograms::{DIM, histograms};
use crate::property;

const METRIC: Metric = Metric::Euclidean;

fn settings(centres: usize) -> KMeans {
    KMeans { centres, restarts: 1, metric: METRIC, ..KMeans::default() }
}

/// The distance of each sample to its nearest centre, summed and divided by their number.
fn slow_distortion(metric: Metric, samples: &[f32], centres: &[f32]) -> f64 {
    let nearest = |sample: &[f32]| {
        let distances = centres.chunks_exact(DIM).map(|centre| metric.distance(sample, centre));
        distances.fold(f64::INFINITY, f64::min)
    };
    samples.chunks_exact(DIM).map(nearest).sum::<f64>() / (samples.len() / DIM) as f64
}

proptest! {
    #![proptest_config(property::cases(24))]

    #[test]
    fn the_distortion_falls_and_is_what_it_says(
        seed: u64,
        centres in 1..60_usize,
        shift in prop_oneof![Just(0.0_f32), Just(50.0)],
        scale in prop_oneof![Just(1e-12_f32), Just(1.0), Just(1e12)],
    ) {
        let samples: Vec<f32> =
            histograms(900, seed).iter().map(|value| scale * (value + shift)).collect();
        let fit = KMeans { seed, tolerance: 0.0, ..settings(centres) }.fit(&samples, DIM)?;
        for pair in fit.report.distortions.windows(2) {
            prop_assert!(pair[1] <= pair[0] * 1.000_1, "{:?}", fit.report.distortions);
        }
        let slow = slow_distortion(METRIC, &samples, fit.codebook.centres());
        prop_assert!((fit.codebook.scale() / slow - 1.0).abs() < 1e-3, "{} {slow}", fit.codebook.scale());
    }

    /// However many centres are left over from the registers' worth that meet a sample at once.
    #[test]
    fn the_nearest_centre_is_the_slow_versions(
        count in 1..260_usize,
        dim in 1..9_usize,
        values in prop::collection::vec(-1e3..1e3_f32, 260 * 8),
        sample in prop::collection::vec(-1e3..1e3_f32, 8),
    ) {
        let (values, sample) = (&values[..count * dim], &sample[..dim]);
        let codebook = Codebook::with_metric(METRIC, values.to_vec(), dim, 1.0)?;
        let nearest = codebook.nearest(sample)?;
        let distances: Vec<f64> =
            values.chunks_exact(dim).map(|centre| squared_euclidean(centre, sample)).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let rounding = 1e-6 * dim as f64 * 1e6;
        prop_assert!(distances[nearest.centre] <= least + 2.0 * rounding);
        prop_assert!((f64::from(nearest.distance) - distances[nearest.centre]).abs() <= rounding);
    }

    /// One batch added again and again is Lloyd's iteration slowed down.
    #[test]
    fn batches_settle_near_where_all_at_once_do(seed: u64) {
        let samples = histograms(3000, seed);
        for metric in [Metric::ChiSquared, METRIC] {
            let settings = KMeans { seed, metric, ..settings(20) };
            let whole = settings.fit(&samples, DIM)?.codebook;
            let mut batches = MiniBatch::new(settings, &samples[..600 * DIM], DIM)?;
            for _ in 0..4 {
                for batch in samples.chunks(600 * DIM) {
                    batches.add(batch)?;
                }
            }
            let batched = slow_distortion(metric, &samples, batches.finish()?.centres());
            let whole = slow_distortion(metric, &samples, whole.centres());
            prop_assert!(batched < 1.35 * whole, "{batched} {whole}");
        }
    }

    #[test]
    fn balls_cover_everything(seed: u64, radius in 0.1..0.6) {
        let samples = histograms(300, seed);
        for metric in [Metric::ChiSquared, METRIC] {
            let cover = FixedRadius { radius, drawn: 60, seed, metric, most: 300 };
            let codebook = cover.fit(&samples, DIM)?;
            let uncovered = samples.chunks_exact(DIM).filter(|sample| {
                codebook.centres().chunks_exact(DIM).all(|c| metric.distance(c, sample) > radius)
            });
            prop_assert_eq!(uncovered.count(), 0);
            prop_assert_eq!(cover.fit(&samples, DIM)?, codebook);
        }
    }
}

/// Lloyd's iteration, in double precision and without any haste, from the same seeds.
#[test]
fn every_iteration_is_the_slow_versions() {
    let samples = histograms(2000, 11);
    for centres in [1, 30, 90, 97] {
        let fit = |max_iterations| {
            let kmeans = KMeans { max_iterations, tolerance: 0.0, ..settings(centres) };
            kmeans.fit(&samples, DIM).expect("a codebook")
        };
        let mut slow = fit(1).codebook.centres().to_vec();
        for iterations in 2..8 {
            slow = slow_iteration(&samples, &slow);
            for (a, b) in fit(iterations).codebook.centres().iter().zip(&slow) {
                assert!((a - b).abs() < 1e-6, "{centres} centres, {iterations}: {a} {b}");
            }
        }
    }
}

/// The mean of the samples of each centre, none of which has lost them all.
fn slow_iteration(samples: &[f32], centres: &[f32]) -> Vec<f32> {
    let mut sums = vec![0.0_f64; centres.len()];
    let mut counts = vec![0.0; centres.len() / DIM];
    for sample in samples.chunks_exact(DIM) {
        let distances = centres.chunks_exact(DIM).map(|centre| squared_euclidean(sample, centre));
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).expect("a centre").0;
        counts[nearest] += 1.0;
        for (sum, &value) in sums[nearest * DIM..].iter_mut().zip(sample) {
            *sum += f64::from(value);
        }
    }
    assert!(counts.iter().all(|&count| count > 0.0), "{counts:?}");
    sums.iter().enumerate().map(|(i, sum)| (sum / counts[i / DIM]) as f32).collect()
}

#[test]
fn one_batch_is_one_iteration() {
    let samples = histograms(500, 3);
    let settings = KMeans { max_iterations: 2, tolerance: 0.0, ..settings(12) };
    let whole = settings.fit(&samples, DIM).expect("a codebook").codebook;
    let batch = MiniBatch::new(settings, &samples, DIM).expect("a batch");
    let batch = batch.finish().expect("a codebook");
    for (a, b) in whole.centres().iter().zip(batch.centres()) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn votes_and_residuals_take_any_numbers() {
    let centres = vec![-5.0, 0.0, 5.0, 0.0];
    let codebook = Codebook::with_metric(METRIC, centres, 2, 1.0).expect("a codebook");
    let samples = [-4.0, 1.0, 4.0, 1.0, 5.0, -1.0];
    let mut votes = [0.0; 2];
    let counts = SoftHistogram { codebook: &codebook, assignment: SoftAssignment::HARD };
    counts.encode(&samples, &mut Scratch::default(), &mut votes).expect("votes");
    assert_eq!(votes, [1.0 / 3.0, 2.0 / 3.0]);
    let mut code = [0.0; 4];
    Vlad { codebook }.encode(&samples, &mut Scratch::default(), &mut code).expect("a code");
    let half = 3.0_f64.sqrt().recip();
    for (found, expected) in code.into_iter().zip([half, half, -half, 0.0]) {
        assert!((found - expected).abs() < 1e-12, "{code:?}");
    }
}

#[test]
fn samples_that_cannot_be_squared_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, 1e16] {
        let samples = [0.0, 1.0, bad, 3.0];
        let error = settings(1).fit(&samples, 2).expect_err("a refusal");
        assert!(matches!(error, Error::BadNumber { index: 1, bin: 0, .. }), "{error}");
    }
    let radius = FixedRadius { radius: f64::NAN, ..FixedRadius::default() };
    assert!(matches!(radius.fit(&histograms(3, 1), DIM), Err(Error::Parameter { .. })));
    let none = FixedRadius { drawn: 0, ..FixedRadius::default() };
    assert!(matches!(
        none.fit(&histograms(3, 1), DIM),
        Err(Error::Parameter { name: "drawn", .. })
    ));
}

/// More candidates, better seeds; and still only samples.
#[test]
fn greedy_seeding_helps() {
    let samples = histograms(2000, 8);
    let mean_of_seeds = |candidates| {
        let of_seed = |seed| {
            let kmeans = KMeans { candidates, seed, max_iterations: 1, ..settings(30) };
            kmeans.fit(&samples, DIM).expect("a codebook").codebook.scale()
        };
        (0..8).map(of_seed).sum::<f64>() / 8.0
    };
    assert!(mean_of_seeds(5) < 0.97 * mean_of_seeds(1));
}
