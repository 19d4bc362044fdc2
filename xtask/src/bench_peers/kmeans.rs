//! Codebooks of 90 centres from 100,000 histograms of 60 bins.

use std::path::Path;

use anyhow::{Context, Result};
use phalanx_codebook::{KMeans, chi_squared};

use super::clock::{median, timed};
use super::peers::{Peers, field};
use super::row::{Figure, Row, Target};

const SAMPLES: usize = 100_000;
const DIM: usize = 60;
const ITERATIONS: usize = 25;
const REPETITIONS: usize = 3;
/// How many samples bench_kmeans.py measures the distortion of, from the first on.
const JUDGED: usize = 20_000;

/// The name that bench_kmeans.py knows a peer by, and its own.
const PEERS: [(&str, &str); 3] =
    [("faiss", "faiss"), ("sklearn", "scikit-learn"), ("opencv", "OpenCV")];

/// What is measured of a codebook.
struct Outcome {
    /// Of an iteration, seeding shared out.
    milliseconds: f64,
    /// Mean χ² of the first samples to their nearest centres.
    distortion: f64,
}

pub(crate) fn rows(peers: &Peers) -> Result<Vec<Row>> {
    let samples = match samples(peers) {
        Ok(samples) => samples,
        Err(error) => return Ok(vec![Row::skipped("K-means", "faiss", &error)]),
    };
    let mut theirs = PEERS.map(|_| Vec::new());
    let mut ours = Vec::new();
    for repetition in 1..=REPETITIONS {
        eprintln!("K-means, round {repetition} of {REPETITIONS}");
        for ((name, _), outcomes) in PEERS.into_iter().zip(&mut theirs) {
            outcomes.push(run_peer(peers, name));
        }
        ours.push(run_ours(&samples)?);
    }
    let work = |statistic| format!("K-means 100,000 × 60, K = 90, {statistic}");
    let time = |outcomes: &[Outcome]| median(outcomes.iter().map(|o| o.milliseconds));
    let distortion = |outcomes: &[Outcome]| median(outcomes.iter().map(|o| o.distortion));
    let figure = |value: Option<f64>| value.map_or(Figure::None, Figure::Value);
    let mut rows = Vec::new();
    for ((_, peer), outcomes) in PEERS.into_iter().zip(theirs) {
        let outcomes: Result<Vec<Outcome>> = outcomes.into_iter().collect();
        let read = |of: &dyn Fn(&[Outcome]) -> Option<f64>| match &outcomes {
            Ok(outcomes) => figure(of(outcomes)),
            Err(error) => Figure::Skipped(format!("{error:#}")),
        };
        rows.push(Row {
            work: work("χ²"),
            figure: "an iteration",
            unit: "ms",
            peer,
            theirs: read(&time),
            ours: figure(time(&ours)),
            target: Target::AtMost(90.0),
        });
        rows.push(Row {
            work: work("χ²"),
            figure: "mean χ² to the nearest centre",
            unit: "",
            peer,
            theirs: read(&distortion),
            ours: figure(distortion(&ours)),
            target: Target::BelowTheirs,
        });
    }
    Ok(rows)
}

/// The samples that bench_kmeans.py makes for itself.
fn samples(peers: &Peers) -> Result<Vec<f32>> {
    let path = peers.data()?.join("histograms.f32");
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
        distortion: field(printed.trim(), "chi2distortion")?,
    })
}

fn run_ours(samples: &[f32]) -> Result<Outcome> {
    let kmeans =
        KMeans { max_iterations: ITERATIONS, restarts: 1, tolerance: 0.0, ..KMeans::default() };
    let (seconds, fit) = timed(|| kmeans.fit(samples, DIM))?;
    let iterations = fit.report.distortions.len();
    let centres = fit.codebook.centres();
    Ok(Outcome {
        milliseconds: 1e3 * seconds / iterations as f64,
        distortion: mean_chi_squared(&samples[..JUDGED * DIM], centres),
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
