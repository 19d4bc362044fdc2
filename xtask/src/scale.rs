//! Time and memory of training on ever more samples.

use std::fmt::Write;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::files;

const SAMPLES: [usize; 5] = [1000, 5000, 10_000, 20_000, 50_000];
/// A training whose time is mostly the fixed cost of codebooks and centres: each sample's own time is
/// that of what comes on top.
const FIXED: usize = 5000;
/// The most memory that 50,000 samples may take, MiB.
const MOST_MIB: f64 = 2048.0;
/// The time per sample is flat while the largest training's stays within this of 10,000 samples'.
const FLAT: f64 = 1.25;

/// What one training took.
struct Cost {
    samples: usize,
    seconds: f64,
    mebibytes: f64,
}

/// A table of trainings, each in a process of its own, so that its memory is its own too.
pub(crate) fn section() -> Result<String> {
    let costs = SAMPLES.map(measure).into_iter().collect::<Result<Vec<_>>>()?;
    let fixed = costs.iter().find(|cost| cost.samples == FIXED).context("the fixed cost")?;
    let mut table = String::from(
        "| samples | time | per sample beyond 5,000 | peak memory | target | |\n|--:|--:|--:|--:|--:|---|\n",
    );
    for cost in &costs {
        let Cost { samples, seconds, mebibytes } = cost;
        let beyond = samples.saturating_sub(FIXED) as f64;
        let each = match beyond {
            0.0 => String::new(),
            beyond => format!("{:.2} ms", 1e3 * (seconds - fixed.seconds) / beyond),
        };
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
    writeln!(table, "\n{}", flatness(&costs, fixed)?)?;
    Ok(table)
}

/// Whether a sample of the largest training costs what one of a middling training does.
fn flatness(costs: &[Cost], fixed: &Cost) -> Result<String> {
    let each = |samples: usize| {
        let cost = costs.iter().find(|cost| cost.samples == samples).context("a measured size")?;
        anyhow::Ok((cost.seconds - fixed.seconds) / (samples - FIXED) as f64)
    };
    let ratio = each(50_000)? / each(10_000)?;
    let verdict = if ratio <= FLAT { "flat" } else { "not flat" };
    Ok(format!(
        "A sample of 50,000 takes {ratio:.2} of the time of one of 10,000: {verdict} (at most {FLAT} asked for)."
    ))
}

/// `cargo xtask train --data-set random --augment --samples N`.
fn measure(samples: usize) -> Result<Cost> {
    let model = files::in_repository("target/performance/scale.phalanx");
    let mut train = Command::new(std::env::current_exe()?);
    train.args(["train", "--data-set", "random", "--augment", "--memory", "--samples"]);
    train.arg(samples.to_string()).arg("--out").arg(&model);
    let start = Instant::now();
    let output = train.output().context("starting the training")?;
    let seconds = start.elapsed().as_secs_f64();
    ensure!(output.status.success(), "training: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    let peak =
        text.lines().find_map(|line| line.strip_prefix("peak memory: ")?.strip_suffix(" MiB"));
    let mebibytes = peak.context("the training does not say its memory")?.parse()?;
    Ok(Cost { samples, seconds, mebibytes })
}
