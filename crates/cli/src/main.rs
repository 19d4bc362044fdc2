//! The `phalanx` program.

mod estimate;
mod input;
mod output;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Joint angles of a bare hand from pictures of calibrated cameras.
///
/// Exit codes: 0, all done; 2, nothing done or wrong use.
#[derive(Parser)]
#[command(name = "phalanx", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Estimate the pose of a hand from one picture per camera.
    Estimate(estimate::Arguments),
}

fn main() -> ExitCode {
    let Command::Estimate(arguments) = Arguments::parse().command;
    match estimate::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("phalanx: {error:#}");
            ExitCode::from(2)
        }
    }
}
