//! `cargo xtask fuzz`: feeds damaged files to everything that reads files.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use clap::Args;

use crate::files;

/// What no target may ask for at once, MiB.
const MOST_ALLOCATED_MIB: usize = 64;
/// How long an execution may take, s.
const MOST_SECONDS: usize = 10;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The targets, as the files of fuzz/fuzz_targets are called; all by default.
    targets: Vec<String>,
    /// Executions of each target.
    #[arg(long, default_value_t = 10_000_000)]
    runs: usize,
    /// Stops a target after so many seconds, however many executions there were; 0 for never.
    #[arg(long, default_value_t = 0)]
    seconds: usize,
    /// Where what was found is kept: a folder of inputs for each target, begun with those of
    /// fuzz/corpus, and the inputs that crash.
    #[arg(long, value_name = "DIR", default_value = "target/fuzz-found")]
    out: PathBuf,
}

/// What became of a target.
struct Outcome {
    target: String,
    executions: String,
    peak_mib: String,
    is_sound: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let programs = build()?;
    let targets = match arguments.targets[..] {
        [] => names(&files::in_repository("fuzz/fuzz_targets"))?,
        _ => arguments.targets.clone(),
    };
    let mut table = String::from("| target | executions | peak memory, MiB | crashes, hangs |\n");
    table += "|---|--:|--:|---|\n";
    let mut all_sound = true;
    for target in &targets {
        let outcome = fuzz(target, &programs, arguments).with_context(|| target.clone())?;
        let found = if outcome.is_sound { "none" } else { "found" };
        let Outcome { target, executions, peak_mib, .. } = &outcome;
        writeln!(table, "| {target} | {executions} | {peak_mib} | {found} |")?;
        all_sound &= outcome.is_sound;
    }
    files::print(&table)?;
    ensure!(all_sound, "what was found is in {}", arguments.out.display());
    Ok(())
}

/// Compiles the targets; returns the folder of their programs.
fn build() -> Result<PathBuf> {
    let target = files::in_repository("target/fuzz");
    let mut cargo = Command::new("rustup");
    cargo.args(["run", "nightly", "cargo", "fuzz", "build", "--target-dir"]).arg(&target);
    let status = cargo.current_dir(files::in_repository("")).status().context("starting rustup")?;
    ensure!(
        status.success(),
        "the targets cannot be compiled; are the nightly toolchain and cargo-fuzz installed?"
    );
    let mut rustc = Command::new("rustup");
    let about = rustc.args(["run", "nightly", "rustc", "-vV"]).output().context("rustc")?;
    let about = String::from_utf8(about.stdout).context("rustc -vV")?;
    let host = about.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(target.join(host.context("rustc does not say what it is for")?).join("release"))
}

/// The names of the files in a folder, without their extensions, in order.
fn names(folder: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut names = Vec::new();
    for entry in entries {
        let path = entry?.path();
        names.push(path.file_stem().context("a file has a name")?.to_string_lossy().into_owned());
    }
    names.sort_unstable();
    Ok(names)
}

fn fuzz(target: &str, programs: &Path, arguments: &Arguments) -> Result<Outcome> {
    eprintln!("fuzzing {target}");
    let inputs = arguments.out.join(target);
    std::fs::create_dir_all(&inputs).with_context(|| inputs.display().to_string())?;
    let log_path = arguments.out.join(target).with_added_extension("log");
    let log = std::fs::File::create(&log_path).with_context(|| log_path.display().to_string())?;
    let mut program = Command::new(programs.join(target));
    program
        .args([&inputs, &files::in_repository("fuzz/corpus").join(target)])
        .arg(format!("-artifact_prefix={}/{target}-", arguments.out.display()))
        .arg(format!("-runs={}", arguments.runs))
        .arg(format!("-max_total_time={}", arguments.seconds))
        .arg(format!("-malloc_limit_mb={MOST_ALLOCATED_MIB}"))
        .arg(format!("-timeout={MOST_SECONDS}"))
        .arg("-print_final_stats=1")
        .stdout(Stdio::null())
        .stderr(log);
    let status = program.status().context("starting the target")?;
    let log = std::fs::read(&log_path).context("reading the log")?;
    let log = String::from_utf8_lossy(&log);
    let statistic = |name: &str| {
        let value = log.lines().find_map(|line| line.strip_prefix(name));
        Ok::<_, anyhow::Error>(
            value.with_context(|| format!("no {name} in the log"))?.trim().to_owned(),
        )
    };
    Ok(Outcome {
        target: target.to_owned(),
        executions: statistic("stat::number_of_executed_units:")?,
        peak_mib: statistic("stat::peak_rss_mb:")?,
        is_sound: status.success(),
    })
}
