//! The experiments and chores of phalanx.

mod contact_sheet;
mod data_set;
mod files;
mod fixtures;
mod metrics;
mod neighbours;
mod performance;
mod pictures;
mod progress;
mod saturation;
mod skin_model;
mod split;
mod table1;
mod train;
mod trajectories;

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
    /// Learn an estimator from synthetic views and save it.
    Train(train::Arguments),
    /// Reproduce the paper's Table 1 beside its own figures.
    #[command(name = "eval-table1")]
    EvalTable1(table1::Arguments),
    /// Regenerate the files in fixtures/, or check that they are as generated.
    Fixtures(fixtures::Arguments),
    /// Train the skin model that the segmentation crate ships.
    SkinModel(skin_model::Arguments),
    /// Draw silhouettes, contours and axes over photographs, and measure the skin model.
    ContactSheet(contact_sheet::Arguments),
    /// Draw the pictures of the README, and photographs to try the program on.
    Pictures(pictures::Arguments),
    /// Time every stage and write docs/performance.md.
    Performance(performance::Arguments),
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<()> {
    let threads = arguments.threads.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.context("starting worker threads")?.install(|| match &arguments.command {
        Command::Train(arguments) => train::run(arguments),
        Command::EvalTable1(arguments) => table1::run(arguments),
        Command::Fixtures(arguments) => fixtures::run(arguments),
        Command::SkinModel(arguments) => skin_model::run(arguments),
        Command::ContactSheet(arguments) => contact_sheet::run(arguments),
        Command::Pictures(arguments) => pictures::run(arguments),
        Command::Performance(arguments) => performance::run(arguments),
    })
}
