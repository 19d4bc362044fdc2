//! Codebooks of 90 centres from 100,000 histograms of 60 bins.

use std::path::Path;

use anyhow::{Context, Result};
use phalanx_codebook::{KMeans, Metric, chi_squared};

use super::programs::{Peers, field};
use super::row::{Figure, Row, Target};
use crate::clock::{middle, timed};

const SAMPLES: usize = 100_000;
const DIM: usize = 60;
const ITERATIONS: usize = 25;
const REPETITIONS: usize = 3;
/// Of how many draws each of our first centres is the best: 2 + ln K, as scikit-learn's.
const CANDIDATES: usize = 6;
/// How many samples bench_kmeans.py measures the distortion of, from the first on.
const JUDGED: usize = 20_000;

/// The name that bench_kmeans.py knows a peer by, and its own.
const PEERS: [(&str, &str); 3] =
    [("faiss", "faiss"), ("sklearn", "scikit-learn"), ("opencv", "OpenCV")];

/// What is measured of a codebook.
struct Outcome {
    /// Of an iteration.
    milliseconds: f64,
    /// Of all of them and what comes before, in seconds.
    total: f64,
    /// Mean χ² of the first samples to their nearest centres.
    distortion: f64,
}

pub(crate) fn rows(peers: &Peers) -> Result<Vec<Row>> {
    let samples = match samples(peers) {
        Ok(samples) => samples,
        Err(error) => return Ok(vec![Row::skipped("K-means", "faiss", &error)]),
    };
    let mut theirs = PEERS.map(|_| Vec::new());
    let (mut by_chi_squared, mut euclidean) = (Vec::new(), Vec::new());
    for repetition in 1..=REPETITIONS {
        eprintln!("K-means, round {repetition} of {REPETITIONS}");
        for ((name, _), outcomes) in PEERS.into_iter().zip(&mut theirs) {
            outcomes.push(run_peer(peers, name));
        }
        by_chi_squared.push(run_ours(&samples, Metric::ChiSquared)?);
        euclidean.push(run_ours(&samples, Metric::Euclidean)?);
    }
    let theirs = theirs.map(|outcomes| outcomes.into_iter().collect::<Result<Vec<_>>>());
    let peers = || PEERS.into_iter().map(|(_, peer)| peer).zip(&theirs);
    let mut rows = Vec::new();
    for (ours, name, most) in [(&by_chi_squared, "χ²", 90.0), (&euclidean, "Euclidean", 31.0)] {
        for (peer, theirs) in peers() {
            let row = |figure, unit, target, of: fn(&Outcome) -> f64| Row {
                work: format!("K-means, {name}, 100,000 × 60, K = 90"),
                figure,
                unit,
                peer,
                theirs: theirs.as_ref().map(|all| middle(all, of)).into(),
                ours: Figure::Value(middle(ours, of)),
                target,
            };
            let below = if name == "χ²" { Target::BelowTheirs } else { Target::Open };
            rows.push(row("an iteration", "ms", Target::AtMost(most), |o| o.milliseconds));
            rows.push(row("25 iterations and their beginning", "s", Target::Open, |o| o.total));
            rows.push(row("mean χ² to the nearest centre", "", below, |o| o.distortion));
        }
    }
    Ok(rows)
}

/// The samples that bench_kmeans.py makes for itself.
fn samples(peers: &Peers) -> Result<Vec<f32>> {
    let path = Peers::data()?.join("histograms.f32");
    if !path.exists() {
        write_samples(peers, &path)?;
    }
    let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
    let (numbers, _) = bytes.as_chunks::<4>();
    anyhow::ensure!(
        numbers.len() == SAMPLES * DIM,
        "{}: {} numbers",
        path.display(),
        numbers.len()
    );
    Ok(numbers.iter().copied().map(f32::from_le_bytes).collect())
}

fn write_samples(peers: &Peers, path: &Path) -> Result<()> {
    let [count, path] = [SAMPLES.to_string(), path.display().to_string()];
    peers.script("dump_data.py", &[&count, &path]).map(drop)
}

fn run_peer(peers: &Peers, name: &str) -> Result<Outcome> {
    let [count, iterations] = [SAMPLES, ITERATIONS].map(|n| n.to_string());
    let printed = peers.script("bench_kmeans.py", &[name, &count, &iterations])?;
    Ok(Outcome {
        milliseconds: field(printed.trim(), "ms_per_iter")?,
        total: field(printed.trim(), "total_s")?,
        distortion: field(printed.trim(), "chi2distortion")?,
    })
}

/// An iteration of ours is the difference that one more makes. The peers' scripts share out what
/// comes before, which is nothing much for faiss, whose first centres are drawn blindly.
fn run_ours(samples: &[f32], metric: Metric) -> Result<Outcome> {
    let fit = |max_iterations| {
        let kmeans = KMeans {
            metric,
            max_iterations,
            restarts: 1,
            tolerance: 0.0,
            candidates: CANDIDATES,
            ..KMeans::default()
        };
        timed(|| kmeans.fit(samples, DIM))
    };
    let (one, _) = fit(1)?;
    let (total, fit) = fit(ITERATIONS)?;
    Ok(Outcome {
        milliseconds: 1e3 * (total - one) / (fit.report.distortions.len() - 1) as f64,
        total,
        distortion: mean_chi_squared(&samples[..JUDGED * DIM], fit.codebook.centres()),
    })
}

fn mean_chi_squared(samples: &[f32], centres: &[f32]) -> f64 {
    let nearest = |sample: &[f32]| {
        centres
            .chunks_exact(DIM)
            .map(|centre| chi_squared(sample, centre))
            .fold(f64::INFINITY, f64::min)
    };
    samples.chunks_exact(DIM).map(nearest).sum::<f64>() / (samples.len() / DIM) as f64
}
