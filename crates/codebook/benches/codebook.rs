//! K-means per iteration, on one thread, and the assignment of one silhouette's contexts.

#[path = "../tests/codebook/histograms.rs"]
mod histograms;

use std::time::{Duration, Instant};

use criterion::{Criterion, SamplingMode, criterion_group, criterion_main};
use histograms::{DIM, histograms};
use phalanx_codebook::{KMeans, Metric, Scratch, SoftAssignment};

/// Short enough for one run a sample.
const KMEANS_TIME: Duration = Duration::from_millis(100);

/// A metric, and what its benchmarks are called.
const METRICS: [(Metric, &str); 2] = [(Metric::ChiSquared, ""), (Metric::Euclidean, ", Euclidean")];

/// One iteration is a tenth of the difference between eleven of them and one.
fn kmeans(c: &mut Criterion) {
    let samples = histograms(100_000, 1);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let fit = |metric, max_iterations| {
        let kmeans =
            KMeans { metric, max_iterations, restarts: 1, tolerance: 0.0, ..KMeans::default() };
        let start = Instant::now();
        pool.install(|| kmeans.fit(&samples, DIM)).expect("a codebook");
        start.elapsed()
    };
    let mut group = c.benchmark_group("K-means 100000x60, K = 90");
    // What is timed is a tenth of what is waited for.
    group.sample_size(10).sampling_mode(SamplingMode::Flat).measurement_time(KMEANS_TIME);
    for (metric, name) in METRICS {
        group.bench_function(format!("one iteration{name}"), |b| {
            let tenth = || fit(metric, 11).saturating_sub(fit(metric, 1)) / 10;
            b.iter_custom(|times| (0..times).map(|_| tenth()).sum::<Duration>());
        });
        group.bench_function(format!("seeding and one assignment{name}"), |b| {
            b.iter(|| fit(metric, 1));
        });
    }
}

fn assignment(c: &mut Criterion) {
    let training = histograms(5_000, 2);
    let contexts = histograms(300, 3);
    let mut group = c.benchmark_group("votes of 300 contexts");
    for centres in [30, 90] {
        let kmeans = KMeans { centres, restarts: 1, ..KMeans::default() };
        let codebook = kmeans.fit(&training, DIM).expect("a codebook").codebook;
        let mut scratch = Scratch::default();
        let mut votes = vec![0.0; centres];
        for neighbours in [3, 8, 30] {
            group.bench_function(format!("{neighbours} of {centres} centres"), |b| {
                let assignment = SoftAssignment { neighbours };
                b.iter(|| codebook.soft_assign(&contexts, assignment, &mut scratch, &mut votes));
            });
        }
    }
}

criterion_group!(benches, kmeans, assignment);
criterion_main!(benches);
