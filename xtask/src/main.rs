//! The experiments and chores of phalanx.

mod cargo;
mod check_crates;
mod fuzz;
mod headline;
mod layers;
mod properties;

use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};

/// The experiments and chores of phalanx.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    /// Worker threads; all cores by default. Results do not depend on it.
    #[arg(long, global = true)]
    threads: Option<usize>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    #[command(flatten)]
    Experiment(phalanx_lab::commands::Command),
    /// Write the README's table: Table 1 beside what was never seen.
    Headline(headline::Arguments),
    /// Check the crates as those get them who depend on one alone: licences, features, packages.
    CheckCrates(check_crates::Arguments),
    /// Check that the arrows between the files of each crate go down.
    Layers,
    /// Try the property tests on other cases than the test command does.
    Properties(properties::Arguments),
    /// Feed damaged files to everything that reads files.
    Fuzz(fuzz::Arguments),
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<ExitCode> {
    // faer's eigenvalues depend in their last bits on how many threads compute them.
    faer::set_global_parallelism(faer::Par::Seq);
    let threads = arguments.threads.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.context("starting worker threads")?.install(|| start(&arguments.command))
}

/// Runs a command; its exit code tells whether all of it was done.
fn start(command: &Command) -> Result<ExitCode> {
    match command {
        Command::Experiment(experiment) => return experiment.run(),
        Command::Headline(arguments) => headline::run(arguments)?,
        Command::CheckCrates(arguments) => check_crates::run(arguments)?,
        Command::Layers => layers::run()?,
        Command::Properties(arguments) => return properties::run(arguments),
        Command::Fuzz(arguments) => fuzz::run(arguments)?,
    }
    Ok(ExitCode::SUCCESS)
}
