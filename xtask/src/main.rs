//! The experiments and chores of phalanx.

mod ablation;
mod bench_peers;
mod cargo;
mod chart;
mod check_crates;
mod contact_sheet;
mod data_set;
mod described;
mod experiments;
mod fixtures;
mod fuzz;
mod global_pose;
mod headline;
mod held_out;
mod hypotheses;
mod lab;
mod layers;
mod memory;
mod merge;
mod metrics;
mod neighbours;
mod orientation;
mod performance;
mod photographs;
mod pictures;
mod plate;
mod postures;
mod presets;
mod principal_axes;
mod properties;
mod refining;
mod report;
mod saturation;
mod scale;
mod scene_list;
mod selection;
mod sets;
mod skin_model;
mod split;
mod table1;
mod train;
mod trajectories;
mod two_camera;
mod wrist_model;

use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};
use phalanx_lab::{files, mosaic, progress};

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
    /// Join the parts of a training that was run in shards.
    Merge(merge::Arguments),
    /// Reproduce the paper's Table 1 beside its own figures.
    #[command(name = "eval-table1")]
    EvalTable1(table1::Arguments),
    /// Test on what was never seen: other motion, hands, cameras, silhouettes.
    #[command(name = "eval-held-out")]
    EvalHeldOut(held_out::Arguments),
    /// Test where hands are found and how they are turned, anywhere in the volume.
    #[command(name = "eval-global")]
    EvalGlobal(global_pose::Arguments),
    /// Compare ways of choosing which samples to keep, and write docs/selection.md.
    Selection(selection::Arguments),
    /// Compare ways of naming several poses for one picture, and write docs/hypotheses.md.
    Hypotheses(hypotheses::Arguments),
    /// Switch off each part of learning and refining in turn, and write docs/ablation.md.
    Ablation(ablation::Arguments),
    /// What the presets cost in time and memory, and how good they are: docs/presets.md.
    Presets(presets::Arguments),
    /// Put one of the paper's figures or claims to the test.
    Experiment(experiments::Arguments),
    /// Run every experiment and write one page that a reader of the paper can follow.
    Report(report::Arguments),
    /// Regenerate the files in fixtures/, or check that they are as generated.
    Fixtures(fixtures::Arguments),
    /// Train the skin model that the segmentation crate ships.
    SkinModel(skin_model::Arguments),
    /// Train the wrist model that the segmentation crate ships, and say how well it finds wrists.
    WristModel(wrist_model::Arguments),
    /// Draw silhouettes, contours and axes over photographs, and measure the skin model.
    ContactSheet(contact_sheet::Arguments),
    /// Find a real hand in the frames of two calibrated webcams, and draw what was seen.
    TwoCamera(two_camera::Arguments),
    /// Evaluate real takes, by cameras used, input and method.
    #[command(name = "eval-real")]
    EvalReal(phalanx_lab::real::Arguments),
    /// Write the README's table: Table 1 beside what was never seen.
    Headline(headline::Arguments),
    /// Draw the pictures of the README, and photographs to try the program on.
    Pictures(pictures::Arguments),
    /// Check the crates as those get them who depend on one alone: licences, features, packages.
    CheckCrates(check_crates::Arguments),
    /// Check that the arrows between the files of each crate go down.
    Layers,
    /// Try the property tests on other cases than the test command does.
    Properties(properties::Arguments),
    /// Feed damaged files to everything that reads files.
    Fuzz(fuzz::Arguments),
    /// Measure our crates beside their best peers, and write docs/peers.md.
    BenchPeers(bench_peers::Arguments),
    /// Time every stage and write docs/performance.md.
    Performance(performance::Arguments),
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
        Command::Train(arguments) => train::run(arguments)?,
        Command::Merge(arguments) => merge::run(arguments)?,
        Command::EvalTable1(arguments) => table1::run(arguments)?,
        Command::EvalHeldOut(arguments) => return held_out::run(arguments),
        Command::EvalGlobal(arguments) => global_pose::run(arguments)?,
        Command::Selection(arguments) => selection::run(arguments)?,
        Command::Hypotheses(arguments) => hypotheses::run(arguments)?,
        Command::Ablation(arguments) => ablation::run(arguments)?,
        Command::Presets(arguments) => presets::run(arguments)?,
        Command::Experiment(arguments) => experiments::run(arguments)?,
        Command::Report(arguments) => return report::run(arguments),
        Command::EvalReal(arguments) => {
            phalanx_lab::real::run(arguments, &train::fast_through_windows)?;
        }
        Command::Headline(arguments) => headline::run(arguments)?,
        Command::Fixtures(arguments) => fixtures::run(arguments)?,
        Command::SkinModel(arguments) => skin_model::run(arguments)?,
        Command::WristModel(arguments) => wrist_model::run(arguments)?,
        Command::ContactSheet(arguments) => contact_sheet::run(arguments)?,
        Command::TwoCamera(arguments) => two_camera::run(arguments)?,
        Command::Pictures(arguments) => pictures::run(arguments)?,
        Command::CheckCrates(arguments) => check_crates::run(arguments)?,
        Command::Layers => layers::run()?,
        Command::Properties(arguments) => return properties::run(arguments),
        Command::Fuzz(arguments) => fuzz::run(arguments)?,
        Command::BenchPeers(arguments) => bench_peers::run(arguments)?,
        Command::Performance(arguments) => performance::run(arguments)?,
    }
    Ok(ExitCode::SUCCESS)
}
