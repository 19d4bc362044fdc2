//! `cargo xtask performance`: times every stage and writes docs/results/performance.md.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::bench::scale;
use crate::files;
use crate::page::Page;

#[derive(Args)]
pub struct Arguments {
    /// Measure each stage for a third of a second: figures to look at, not to keep.
    #[arg(long)]
    quick: bool,
}

/// The packages that have benchmarks.
const PACKAGES: [&str; 9] = [
    "phalanx",
    "phalanx-camera",
    "phalanx-codebook",
    "phalanx-hand",
    "phalanx-refine",
    "phalanx-render",
    "phalanx-rvm",
    "phalanx-segmentation",
    "phalanx-shape-context",
];

/// A line of a table: a benchmark's id, what it is, and the most milliseconds it should take.
type Row = (&'static str, &'static str, Option<f64>);

#[rustfmt::skip]
const ESTIMATING: &[Row] = &[
    ("three 640x480 photographs to a pose/kernel ridge", "**three decoded 640×480 photographs → pose ± σ**, kernel ridge, 837 centres", Some(5.0)),
    ("three 640x480 photographs to a pose/both", "**the same**, \"both\" kernels, 34 features and 38 centres", Some(5.0)),
    ("three 640x480 masks to a pose/kernel ridge", "three 640×480 masks → pose ± σ, kernel ridge", None),
    ("three 640x480 masks to a pose/both", "the same, \"both\" kernels", None),
    ("downsample 640x480 to 120x90", "640×480 photograph → 120×90", None),
    ("skin 120x90", "skin, 120×90", None),
    ("bright wall 120x90", "plain wall, 120×90", None),
    ("clean 120x90", "clean the mask", None),
    ("contour 120x90", "contour", None),
    ("silhouette of a clean mask 120x90", "contour, and the forearm's end", None),
    ("colour to silhouette 120x90", "skin, clean, contour, forearm together", None),
    ("300 points/hand axis", "**300 shape contexts**, hand axis", Some(0.4)),
    ("300 points/image axes", "300 shape contexts, image axes", None),
    ("300 points/tangent", "300 shape contexts, tangent", None),
    ("300 points/centroid", "300 shape contexts, centroid", None),
    ("300 points/principal axis", "300 shape contexts, principal axis", None),
    ("300 points/mean distance", "the mean distance among 300 points alone", None),
    ("votes of 300 contexts/3 of 30 centres", "300 contexts vote into 3 of 30 centres", None),
    ("votes of 300 contexts/8 of 30 centres", "300 contexts vote into 8 of 30 centres", None),
    ("votes of 300 contexts/30 of 30 centres", "300 contexts vote into all 30 centres", None),
    ("votes of 300 contexts/3 of 90 centres", "300 contexts vote into 3 of 90 centres", None),
    ("votes of 300 contexts/8 of 90 centres", "300 contexts vote into 8 of 90 centres", None),
    ("votes of 300 contexts/30 of 90 centres", "300 contexts vote into 30 of 90 centres", None),
    ("evidence of three 120x90 silhouettes", "the borders of three silhouettes, to refine by", None),
    ("refine three 120x90 silhouettes", "**refine one pose by them**", Some(20.0)),
    ("predict 24 from 38 centres of 32/mean", "24 means, 38 Gaussian centres on 32 features", None),
    ("predict 24 from 38 centres of 32/mean and deviation", "24 means and deviations, the same", None),
    ("predict 24 from 837 centres of 90/mean", "24 means, kernel ridge, 837 centres on 90 features", None),
    ("predict 24 from 837 centres of 90/mean and deviation", "24 means and deviations, the same", None),
];

#[rustfmt::skip]
const TRAINING: &[Row] = &[
    ("draw and describe ten poses in three views", "draw and describe ten poses in three views", None),
    ("joints and solids of a pose", "one pose → 21 joints and the solids", None),
    ("project/pinhole", "project a point", None),
    ("project/lens", "project a point through a distorting lens", None),
    ("unproject/pinhole", "a pixel's ray", None),
    ("unproject/lens", "a pixel's ray through a distorting lens", None),
    ("three silhouettes/pinhole", "**draw three 120×90 silhouettes**", Some(0.5)),
    ("three silhouettes/lens", "the same through a distorting lens", Some(0.5)),
    ("coverage, 4×4 samples/pinhole", "one 120×90 coverage, 4×4 samples", None),
    ("coverage, 4×4 samples/lens", "the same through a distorting lens", None),
    ("depth/pinhole", "one 120×90 depth map", None),
    ("depth/lens", "the same through a distorting lens", None),
    ("shaded, 2×2 samples/pinhole", "one 120×90 shaded picture, 2×2 samples", None),
    ("shaded, 2×2 samples/lens", "the same through a distorting lens", None),
    ("K-means 100000x60, K = 90/one iteration", "K-means by χ², 100,000 × 60, K = 90: one iteration", None),
    ("K-means 100000x60, K = 90/seeding and one assignment", "the same: seeding and one assignment", None),
    ("K-means 100000x60, K = 90/one iteration, Euclidean", "K-means, Euclidean: one iteration", None),
    ("K-means 100000x60, K = 90/seeding and one assignment, Euclidean", "the same: seeding and one assignment", None),
    ("fit 837x90 to 24/bridges linear to 40", "fit 837 × 90 → 24: bridges, linear, 40 features", None),
    ("fit 837x90 to 24/bridges gaussian to 40", "the same: bridges, Gaussian, 40 samples", None),
    ("fit 837x90 to 24/forward gaussian to 40", "the same: forward selection, Gaussian, 40 samples", None),
    ("fit 837x90 to 24/Tipping linear", "the same: Tipping for each output, linear", None),
    ("fit 837x90 to 24/kernel ridge, 7 lambdas", "the same: kernel ridge, 7 penalties to choose from", None),
    ("sums over 1000 Gaussians of 90 inputs/add a block of 512", "add 512 samples to the sums over 1,000 Gaussian columns", None),
    ("sums over 1000 Gaussians of 90 inputs/Nyström, 6 lambdas", "fit from these sums: Nyström, 6 penalties to choose from", None),
    ("sums over 1000 Gaussians of 90 inputs/forward to 40", "the same: forward selection of 40", None),
    ("sums over 1000 Gaussians of 90 inputs/bridges to 40", "the same: bridges to 40", None),
];

fn rows() -> impl Iterator<Item = &'static Row> {
    ESTIMATING.iter().chain(TRAINING)
}

/// What others take: the task, who measured what, and the benchmark it may be compared with.
#[rustfmt::skip]
const OTHERS: &[(&str, &str, &str)] = &[
    ("three pictures → pose", "652 ms, 170 ms of it for each picture: de Campos and Murray (2006), Matlab, Pentium 4", "three 640x480 photographs to a pose/both"),
    ("three pictures → pose", "39 ms: MediaPipe Hands 0.10.21 tracking three cameras (landmarks, not angles)", "three 640x480 photographs to a pose/kernel ridge"),
    ("300 shape contexts", "10.9 ms: OpenCV, C++", "300 points/hand axis"),
    ("300 shape contexts", "4.0 ms: a loop in Python, compiled", "300 points/hand axis"),
];

/// Criterion's `benchmark.json`, as far as it is read.
#[derive(Deserialize)]
struct Benchmark {
    full_id: String,
}

/// Criterion's `estimates.json`, as far as it is read.
#[derive(Deserialize)]
struct Estimates {
    median: Median,
}

/// Nanoseconds.
#[derive(Deserialize)]
struct Median {
    point_estimate: f64,
    confidence_interval: Interval,
}

#[derive(Deserialize)]
struct Interval {
    lower_bound: f64,
    upper_bound: f64,
}

/// Medians by the benchmark's id.
type Medians = BTreeMap<String, Median>;

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let results = files::in_repository("target/performance");
    // What an earlier run left there might be of benchmarks that are no more.
    if results.exists() {
        std::fs::remove_dir_all(&results).with_context(|| results.display().to_string())?;
    }
    measure(arguments, &results)?;
    let mut medians = Medians::new();
    read(&results, &mut medians)?;
    let command =
        if arguments.quick { "cargo xtask performance --quick" } else { "cargo xtask performance" };
    let page = Page { file: "performance.md", command, title: "Performance" };
    page.write(&body(command, &medians, &scale::section()?)?)?;
    files::print(&format!("docs/results/{}: {} benchmarks\n", page.file, medians.len()))
}

/// Runs the benchmarks; criterion leaves its figures in `results`.
fn measure(arguments: &Arguments, results: &Path) -> Result<()> {
    let [warm_up, measurement, samples] =
        if arguments.quick { ["0.1", "0.3", "10"] } else { ["0.5", "1.5", "30"] };
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo.current_dir(files::in_repository("")).env("RAYON_NUM_THREADS", "1");
    cargo.env("CRITERION_HOME", results).arg("bench");
    cargo.args(PACKAGES.iter().flat_map(|package| ["--package", package]));
    cargo.args(["--", "--noplot", "--warm-up-time", warm_up]);
    cargo.args(["--measurement-time", measurement, "--sample-size", samples]);
    let status = cargo.status().context("starting cargo bench")?;
    ensure!(status.success(), "cargo bench: {status}");
    Ok(())
}

/// Collects the newest median of every benchmark below a folder of criterion's.
fn read(folder: &Path, medians: &mut Medians) -> Result<()> {
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        let newest = path.join("new");
        if newest.is_dir() {
            let benchmark: Benchmark = read_json(&newest.join("benchmark.json"))?;
            let estimates: Estimates = read_json(&newest.join("estimates.json"))?;
            medians.insert(benchmark.full_id, estimates.median);
        } else if path.is_dir() {
            read(&path, medians)?;
        }
    }
    Ok(())
}

fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let name = || path.display().to_string();
    serde_json::from_slice(&std::fs::read(path).with_context(name)?).with_context(name)
}

fn body(command: &str, medians: &Medians, scale: &str) -> Result<String> {
    if let Some(id) = medians.keys().find(|id| rows().all(|row| row.0 != **id)) {
        bail!("no table has a line for the benchmark '{id}'");
    }
    Ok(format!(
        "`{command}` measured every figure of this page but those of others, and wrote it.\n\n\
         measured on: {}, one thread unless said\n\n\
         Medians, and the 95 % confidence intervals of the medians, by criterion. A target is met\n\
         if the median is within it. On a shared computer figures vary from run to run by more\n\
         than their intervals say. What whole presets take, 95th percentiles too, is in\n\
         [presets.md](presets.md), by `cargo xtask presets`.\n\n\
         ## From pictures to a pose\n\n{}\n\
         ## Training\n\n{}\n\
         ## Training on many samples\n\n\
         `cargo xtask train --data-set random --augment --samples N`, three views, all cores, each in a\n\
         process of its own. Codebooks from 1,000 samples and 2,000 kernel centres are a fixed cost.\n\n{}\n\
         ## Beside others\n\n\
         The figures of others come from other runs, and the paper's from another computer: they\n\
         are for orientation.\n\n{}",
        processor(),
        stages(ESTIMATING, medians)?,
        stages(TRAINING, medians)?,
        scale,
        others(medians)?,
    ))
}

fn median<'a>(id: &str, medians: &'a Medians) -> Result<&'a Median> {
    medians.get(id).with_context(|| format!("there is no benchmark '{id}'"))
}

fn stages(rows: &[Row], medians: &Medians) -> Result<String> {
    let mut table =
        String::from("| stage | median | interval | target | |\n|---|--:|--:|--:|---|\n");
    for &(id, label, target) in rows {
        let Median { point_estimate, confidence_interval } = median(id, medians)?;
        let (limit, verdict) = match target {
            None => (String::new(), String::new()),
            Some(target) => (format!("{target} ms"), verdict(*point_estimate, target * 1e6)),
        };
        let interval = [confidence_interval.lower_bound, confidence_interval.upper_bound];
        let [lower, upper] = interval.map(duration);
        let middle = duration(*point_estimate);
        writeln!(table, "| {label} | {middle} | {lower} – {upper} | {limit} | {verdict} |")?;
    }
    Ok(table)
}

fn others(medians: &Medians) -> Result<String> {
    let mut table = String::from("| task | elsewhere | here |\n|---|---|--:|\n");
    for &(task, elsewhere, id) in OTHERS {
        let here = duration(median(id, medians)?.point_estimate);
        writeln!(table, "| {task} | {elsewhere} | {here} |")?;
    }
    Ok(table)
}

fn verdict(nanoseconds: f64, target: f64) -> String {
    if nanoseconds <= target {
        "met".into()
    } else {
        format!("missed by {}", duration(nanoseconds - target))
    }
}

/// Three digits and a unit.
fn duration(nanoseconds: f64) -> String {
    let units = [(1e9, "s"), (1e6, "ms"), (1e3, "µs")];
    let (size, unit) =
        units.into_iter().find(|(size, _)| nanoseconds >= *size).unwrap_or((1.0, "ns"));
    let value = nanoseconds / size;
    let decimals = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.decimals$} {unit}")
}

/// The processor's name and its number of cores.
fn processor() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{}, {cores} cores", processor_name())
}

/// The processor's name, where the system tells.
pub(crate) fn processor_name() -> String {
    let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    information
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map_or("a processor without a name", |(_, name)| name.trim())
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn medians() -> Medians {
        let median = || Median {
            point_estimate: 450_000.0,
            confidence_interval: Interval { lower_bound: 4.0, upper_bound: 1.5e9 },
        };
        rows().map(|row| (row.0.to_owned(), median())).collect()
    }

    #[test]
    fn targets_are_met_or_missed_by_so_much() {
        let page = body("cargo xtask performance", &medians(), "").unwrap();
        let line = |label| page.lines().find(|line| line.contains(label)).unwrap();
        assert!(
            line("**300 shape")
                .ends_with("| 450 µs | 4.00 ns – 1.50 s | 0.4 ms | missed by 50.0 µs |")
        );
        assert!(line("**draw three").ends_with("| 0.5 ms | met |"));
    }

    #[test]
    fn benchmarks_and_lines_must_agree() {
        let fails = |medians: &Medians| body("", medians, "").unwrap_err();
        let mut missing = medians();
        missing.remove("depth/lens");
        assert!(fails(&missing).to_string().contains("depth/lens"));
        let mut unknown = medians();
        let other = unknown.remove("skin 120x90").unwrap();
        unknown.insert("paint".to_owned(), other);
        assert!(fails(&unknown).to_string().contains("paint"));
    }
}
