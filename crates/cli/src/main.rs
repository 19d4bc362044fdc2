//! The `phalanx` program.

mod calibrate_hand;
mod checkpoint;
mod completions;
mod convert;
mod counts;
mod demo;
mod doctor;
mod estimate;
mod evaluate;
mod finding;
mod forecast;
mod form;
mod import_calibration;
mod input;
mod manual;
mod mask;
mod no_hand;
mod output;
mod postures;
mod progress;
mod recording;
mod report;
mod rig;
mod segment;
mod side;
mod skin;
mod take_file;
mod track;
mod train;
mod view;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

/// Joint angles of a bare hand from pictures of calibrated cameras.
///
/// Exit codes: 0, all done; 1, some frames failed and are named; 2, nothing done or wrong use.
#[derive(Parser)]
#[command(name = "phalanx", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Draw a moving hand before three cameras, fit it, and say what to do next.
    Demo(demo::Arguments),
    /// Learn a model for a rig from pictures that are drawn.
    Train(train::Arguments),
    /// Join the parts of a training that was run in shards.
    Merge(train::MergeArguments),
    /// Fit the hand in every frame of a recording, and write its angles.
    Track(track::Arguments),
    /// Estimate the pose of a hand from a picture of each camera, or of some.
    Estimate(estimate::Arguments),
    /// Fit the proportions of a person's hand to pictures of it.
    CalibrateHand(calibrate_hand::Arguments),
    /// Learn from your own pictures how to tell the hand from the rest.
    Skin(skin::Arguments),
    /// Rigs of cameras, from other tools and for them.
    #[command(subcommand)]
    Rig(rig::Command),
    /// Make a rig file of a calibration (the older name of `rig import`).
    ImportCalibration(import_calibration::Arguments),
    /// Write a take as a file of another tool.
    Convert(convert::Arguments),
    /// Write a page on which to look at a take.
    View(view::Arguments),
    /// Print the range of motion of a take, or of two side by side.
    Report(report::Arguments),
    /// Compare a take with a reference: errors, whether deviations keep their promise, lag.
    Evaluate(evaluate::Arguments),
    /// Say what works and what is wrong: the program, a rig, a model, a recording.
    Doctor(doctor::Arguments),
    /// Print what completes the program's commands and options in a shell.
    Completions(completions::Arguments),
    /// Write the program's manual pages.
    Man(manual::Arguments),
}

fn main() -> ExitCode {
    run(&Arguments::parse().command).unwrap_or_else(|error| {
        eprintln!("phalanx: {error:#}");
        ExitCode::from(2)
    })
}

/// Runs a command; its exit code tells whether all of it was done.
fn run(command: &Command) -> anyhow::Result<ExitCode> {
    match command {
        Command::Demo(arguments) => demo::run(arguments)?,
        Command::Train(arguments) => train::train(arguments)?,
        Command::Merge(arguments) => train::merge(arguments)?,
        Command::Track(arguments) => return track::run(arguments),
        Command::Estimate(arguments) => return estimate::run(arguments),
        Command::CalibrateHand(arguments) => calibrate_hand::run(arguments)?,
        Command::Skin(arguments) => skin::run(arguments)?,
        Command::Rig(command) => rig::run(command)?,
        Command::ImportCalibration(arguments) => import_calibration::run(arguments)?,
        Command::Convert(arguments) => convert::run(arguments)?,
        Command::View(arguments) => view::run(arguments)?,
        Command::Report(arguments) => report::run(arguments)?,
        Command::Evaluate(arguments) => evaluate::run(arguments)?,
        Command::Doctor(arguments) => return doctor::run(arguments),
        Command::Completions(arguments) => completions::run(arguments, Arguments::command())?,
        Command::Man(arguments) => manual::run(arguments, Arguments::command())?,
    }
    Ok(ExitCode::SUCCESS)
}
