//! Time and memory of training on ever more samples.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};

use crate::files;

const SAMPLES: [usize; 5] = [1000, 5000, 10_000, 20_000, 50_000];
/// The most memory that 50,000 samples may take, MiB.
const MOST_MIB: f64 = 2048.0;
/// The time per sample is flat while that of the last samples stays within this of the time of those
/// before: both are large steps, so that the fixed cost of codebooks and centres does not count.
const FLAT: f64 = 1.25;

/// What one training took.
struct Cost {
    samples: usize,
    seconds: f64,
    mebibytes: f64,
}

/// A table of trainings, each in a process of its own, so that its memory is its own too.
pub(crate) fn section() -> Result<String> {
    let costs: Vec<Cost> = SAMPLES.into_iter().map(measure).collect::<Result<_>>()?;
    let mut table = String::from(
        "| samples | time | per sample beyond the line above | peak memory | target | |\n|--:|--:|--:|--:|--:|---|\n",
    );
    for (k, cost) in costs.iter().enumerate() {
        let Cost { samples, seconds, mebibytes } = cost;
        let before = k.checked_sub(1).map(|before| &costs[before]);
        let each = before
            .map_or_else(String::new, |before| format!("{:.2} ms", 1e3 * beyond(cost, before)));
        let (target, verdict) = match samples {
            50_000 if *mebibytes <= MOST_MIB => (format!("{MOST_MIB} MiB"), "met".to_owned()),
            50_000 => {
                (format!("{MOST_MIB} MiB"), format!("missed by {:.0} MiB", mebibytes - MOST_MIB))
            }
            _ => (String::new(), String::new()),
        };
        let row = format!("| {samples} | {seconds:.1} s | {each} | {mebibytes:.0} MiB |");
        writeln!(table, "{row} {target} | {verdict} |")?;
    }
    writeln!(table, "\n{}", flatness(&costs)?)?;
    Ok(table)
}

/// Seconds of each sample that one training has beyond another.
fn beyond(more: &Cost, less: &Cost) -> f64 {
    (more.seconds - less.seconds) / (more.samples - less.samples) as f64
}

/// Whether the last samples of the largest training cost what those before them do.
fn flatness(costs: &[Cost]) -> Result<String> {
    let [.., small, middling, large] = costs else { bail!("three trainings are compared") };
    let ratio = beyond(large, middling) / beyond(middling, small);
    let verdict = if ratio <= FLAT { "flat" } else { "not flat" };
    let (last, before) = (large.samples, middling.samples);
    Ok(format!(
        "Up to {last} a sample takes {ratio:.2} of the time that one takes up to {before}: {verdict} (at most {FLAT} asked for)."
    ))
}

/// `cargo xtask train --data-set random --augment --samples N`.
fn measure(samples: usize) -> Result<Cost> {
    let model = files::in_repository("target/performance/scale.phalanx");
    let (seconds, mebibytes) =
        train(&["--data-set", "random", "--augment", "--samples", &samples.to_string()], &model)?;
    Ok(Cost { samples, seconds, mebibytes })
}

/// Seconds and MiB that a training takes in a process of its own.
pub(crate) fn train(arguments: &[&str], model: &Path) -> Result<(f64, f64)> {
    let mut train = Command::new(std::env::current_exe()?);
    train.arg("train").args(arguments).arg("--memory").arg("--out").arg(model);
    let start = Instant::now();
    let output = train.output().context("starting the training")?;
    let seconds = start.elapsed().as_secs_f64();
    ensure!(output.status.success(), "training: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    let peak =
        text.lines().find_map(|line| line.strip_prefix("peak memory: ")?.strip_suffix(" MiB"));
    let mebibytes = peak.context("the training does not say its memory")?.parse()?;
    Ok((seconds, mebibytes))
}
