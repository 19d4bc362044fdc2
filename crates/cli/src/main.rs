//! The `phalanx` program.

mod calibrate_hand;
mod estimate;
mod import_calibration;
mod input;
mod output;
mod progress;
mod rig;
mod train;

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
    /// Learn a model for a rig from pictures that are drawn.
    Train(train::Arguments),
    /// Join the parts of a training that was run in shards.
    Merge(train::MergeArguments),
    /// Estimate the pose of a hand from one picture per camera.
    Estimate(estimate::Arguments),
    /// Fit the proportions of a person's hand to pictures of it.
    CalibrateHand(calibrate_hand::Arguments),
    /// Rigs of cameras, from other tools and for them.
    #[command(subcommand)]
    Rig(rig::Command),
    /// Make a rig file of a calibration (the older name of `rig import`).
    ImportCalibration(import_calibration::Arguments),
}

fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Train(arguments) => train::train(&arguments),
        Command::Merge(arguments) => train::merge(&arguments),
        Command::Estimate(arguments) => estimate::run(&arguments),
        Command::CalibrateHand(arguments) => calibrate_hand::run(&arguments),
        Command::Rig(command) => rig::run(&command),
        Command::ImportCalibration(arguments) => import_calibration::run(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("phalanx: {error:#}");
            ExitCode::from(2)
        }
    }
}
