//! `cargo xtask fuzz`: feeds damaged files to everything that reads files. Writes docs/results/fuzzing.md.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use clap::Args;

use phalanx_lab::files;

const PAGE: &str = "docs/results/fuzzing.md";

/// What no target may hold at once, MiB; fuzz/limit.rs sees to it.
const MOST_ALLOCATED_MIB: usize = 64;
/// How long an execution may take, s; on a busy computer, ten times what it takes of its own.
const MOST_SECONDS: usize = 10;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The targets, as the files of fuzz/fuzz_targets are called; all by default.
    targets: Vec<String>,
    /// Executions of each target.
    #[arg(long, default_value_t = 1_000_000)]
    runs: usize,
    /// Stops a target after so many seconds, however many executions there were; 0 for never.
    #[arg(long, default_value_t = 0)]
    seconds: usize,
    /// Where what was found is kept: a folder of inputs for each target, begun with those of
    /// fuzz/corpus, and the inputs that crash.
    #[arg(long, value_name = "DIR", default_value = "target/fuzz-found")]
    out: PathBuf,
    /// Fuzz nothing: only write the page anew, of what is in DIR.
    #[arg(long)]
    report: bool,
}

/// What the last run of a target came to.
struct Outcome {
    executions: usize,
    /// Of the fuzzer as a whole.
    peak_mib: usize,
    /// How it ended, if an input crashed it, took too long or asked for too much memory.
    found: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let all = names(&files::in_repository("fuzz/fuzz_targets"))?;
    let targets = if arguments.targets.is_empty() { &all } else { &arguments.targets };
    if !arguments.report {
        let programs = build()?;
        for target in targets {
            fuzz(target, &programs, arguments).with_context(|| target.clone())?;
        }
    }
    let mut outcomes = Vec::new();
    for target in &all {
        let log = log_path(target, arguments);
        let outcome = if log.exists() { Some(Outcome::read(&log)?) } else { None };
        outcomes.push((target.as_str(), outcome));
    }
    let earlier = std::fs::read_to_string(files::in_repository(PAGE)).unwrap_or_default();
    let page = page(&outcomes, &earlier)?;
    files::print(&page)?;
    files::write_whole(&files::in_repository(PAGE), page.as_bytes())?;
    let is_sound = |(_, outcome): &(_, Option<Outcome>)| {
        outcome.as_ref().is_none_or(|outcome| outcome.found.is_none())
    };
    ensure!(outcomes.iter().all(is_sound), "what was found is in {}", arguments.out.display());
    Ok(())
}

/// The page, with the lines of an earlier one for targets that were not run since.
fn page(outcomes: &[(&str, Option<Outcome>)], earlier: &str) -> Result<String> {
    let mut page = format!(
        "<!-- Written by `cargo xtask fuzz`; not to be edited. -->\n# Fuzzing\n\n\
         Damaged files, made by libFuzzer from those of `fuzz/corpus`, for everything that is read\n\
         from files. An input is found if it crashes the target, takes longer than \
         {MOST_SECONDS} s, or makes it hold\nmore than {MOST_ALLOCATED_MIB} MiB at once. \
         There are no sanitizers: the crates forbid unsafe code.\nExecutions are those of each target's last run; \
         the memory is the fuzzer's as a whole, with all inputs\nthat it keeps. Of `fuzz/corpus` itself each file \
         takes less than a second of a core's time and 64 MiB: a test of\nxtask, `fuzz_corpus`, sees to it.\n\n\
         | target | executions | peak memory, MiB | found |\n|---|--:|--:|---|\n"
    );
    for (target, outcome) in outcomes {
        let start = format!("| {target} | ");
        match outcome {
            Some(Outcome { executions, peak_mib, found }) => {
                let found = found.as_deref().unwrap_or("nothing");
                writeln!(page, "{start}{executions} | {peak_mib} | {found} |")?;
            }
            // As an earlier run left it.
            None => match earlier.lines().find(|line| line.starts_with(&start)) {
                Some(line) => writeln!(page, "{line}")?,
                None => writeln!(page, "{start}not run | | |")?,
            },
        }
    }
    Ok(page)
}

/// Counts branches and compares for libFuzzer, and keeps assertions.
const INSTRUMENTED: [&str; 7] = [
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "-Ccodegen-units=1",
    "-Cdebug-assertions",
];

/// Compiles the targets; returns the folder of their programs.
fn build() -> Result<PathBuf> {
    let rustc = Command::new("rustc").arg("-vV").output().context("rustc")?;
    let about = String::from_utf8(rustc.stdout).context("rustc -vV")?;
    let host = about.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.context("rustc does not say what it is for")?;
    let target = files::in_repository("target/fuzz");
    let mut cargo = Command::new("cargo");
    // A named target leaves what runs while compiling as it is.
    cargo.args(["build", "--release", "--target", host, "--target-dir"]).arg(&target);
    cargo.current_dir(files::in_repository("fuzz")).env("RUSTFLAGS", INSTRUMENTED.join(" "));
    let status = cargo.status().context("starting cargo")?;
    ensure!(status.success(), "the targets cannot be compiled; is a compiler of C++ installed?");
    Ok(target.join(host).join("release"))
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

fn log_path(target: &str, arguments: &Arguments) -> PathBuf {
    arguments.out.join(target).with_added_extension("log")
}

/// Runs a target, whose log says what it came to.
fn fuzz(target: &str, programs: &Path, arguments: &Arguments) -> Result<()> {
    eprintln!("fuzzing {target}");
    let inputs = arguments.out.join(target);
    std::fs::create_dir_all(&inputs).with_context(|| inputs.display().to_string())?;
    let log = log_path(target, arguments);
    let log = std::fs::File::create(&log).with_context(|| log.display().to_string())?;
    let mut program = Command::new(programs.join(target));
    program
        .args([&inputs, &files::in_repository("fuzz/corpus").join(target)])
        .arg(format!("-artifact_prefix={}/{target}-", arguments.out.display()))
        .arg(format!("-runs={}", arguments.runs))
        .arg(format!("-max_total_time={}", arguments.seconds))
        .arg(format!("-timeout={MOST_SECONDS}"))
        .arg("-print_final_stats=1")
        .stdout(Stdio::null())
        .stderr(log);
    program.status().context("starting the target")?;
    Ok(())
}

impl Outcome {
    fn read(path: &Path) -> Result<Self> {
        let log = std::fs::read(path).with_context(|| path.display().to_string())?;
        let log = String::from_utf8_lossy(&log);
        let after = |start: &str| log.lines().find_map(|line| line.strip_prefix(start));
        let statistic = |name: &str| {
            let value = after(&format!("stat::{name}:"));
            let value = value.with_context(|| format!("{}: no {name}", path.display()))?;
            value.trim().parse().with_context(|| format!("{}: {name}", path.display()))
        };
        Ok(Self {
            executions: statistic("number_of_executed_units")?,
            peak_mib: statistic("peak_rss_mb")?,
            found: after("SUMMARY: ").map(str::to_owned),
        })
    }
}
