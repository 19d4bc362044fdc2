//! The experiments as commands of `cargo xtask`: one registry of them.

use std::process::ExitCode;

use anyhow::Result;
use clap::Subcommand;

use crate::bench::{cost, flat_memory, peers, performance};
use crate::data::fixtures;
use crate::eval::{
    ablation, doubts, global_pose, held_out, hypotheses, presets, reliability, selection, subsets,
    table1, tracking,
};
use crate::figures::pictures;
use crate::models::{end_model, skin_model, wrist_model};
use crate::paper;
use crate::paper::page;
use crate::real::{self, contact_sheet, drawn_takes, interior_edges, two_camera};
use crate::recipes::{merge, train};

/// An experiment.
#[derive(Subcommand)]
#[non_exhaustive]
pub enum Command {
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
    /// Test one model on any of its cameras, beside models for just these: docs/results/subsets.md.
    EvalSubsets(subsets::Arguments),
    /// Find out how often the truth is as near as deviations promise: docs/results/reliability.md.
    Reliability(reliability::Arguments),
    /// Find out which wrong answers are doubted, and for which cause: docs/results/doubts.md.
    Doubts(doubts::Arguments),
    /// Measure how still and how late a drawn hand is tracked: docs/results/tracking.md.
    #[command(name = "eval-tracking")]
    EvalTracking(tracking::Arguments),
    /// Evaluate real takes, by cameras used, input and method.
    #[command(name = "eval-real")]
    EvalReal(Box<real::Arguments>),
    /// Compare poses of real takes with and without the edges inside silhouettes.
    InteriorEdges(interior_edges::Arguments),
    /// Draw takes of other hands before other rigs, laid out as real ones are.
    DrawTakes(drawn_takes::Arguments),
    /// Compare ways of choosing which samples to keep, and write docs/results/selection.md.
    Selection(selection::Arguments),
    /// Compare ways of naming several poses for one picture, and write docs/results/hypotheses.md.
    Hypotheses(hypotheses::Arguments),
    /// Switch off each part of learning and refining in turn, and write docs/results/ablation.md.
    Ablation(ablation::Arguments),
    /// What the presets cost in time and memory, and how good they are: docs/results/presets.md.
    Presets(presets::Arguments),
    /// Put one of the paper's figures or claims to the test.
    Experiment(paper::Arguments),
    /// Run every experiment and write one page that a reader of the paper can follow.
    Report(page::Arguments),
    /// Train the skin model that the segmentation crate ships.
    SkinModel(skin_model::Arguments),
    /// Train the model of an arm's ends that the segmentation crate ships, and say how often it is right.
    EndModel(end_model::Arguments),
    /// Train the wrist model that the segmentation crate ships, and say how well it finds wrists.
    WristModel(wrist_model::Arguments),
    /// Draw silhouettes, contours and axes over photographs, and measure the skin model.
    ContactSheet(contact_sheet::Arguments),
    /// Find a real hand in the frames of two calibrated webcams, and draw what was seen.
    TwoCamera(two_camera::Arguments),
    /// Regenerate the files in fixtures/, or check that they are as generated.
    Fixtures(fixtures::Arguments),
    /// Draw the pictures of the README, and photographs to try the program on.
    Pictures(pictures::Arguments),
    /// Measure our crates beside their best peers, and write docs/results/peers.md.
    BenchPeers(peers::Arguments),
    /// Time every stage and write docs/results/performance.md.
    Performance(performance::Arguments),
    /// Measure what scenes and recordings cost, and what workers save: docs/results/cost.md.
    Cost(cost::Arguments),
    /// Measure how much memory tracking takes, the longer a recording is.
    FlatMemory(flat_memory::Arguments),
}

impl Command {
    /// Runs the experiment; the exit code tells whether all of it was done.
    ///
    /// # Errors
    /// Whatever keeps the experiment from a result.
    pub fn run(&self) -> Result<ExitCode> {
        match self {
            Self::Train(arguments) => train::run(arguments)?,
            Self::Merge(arguments) => merge::run(arguments)?,
            Self::EvalTable1(arguments) => table1::run(arguments)?,
            Self::EvalHeldOut(arguments) => return held_out::run(arguments),
            Self::EvalGlobal(arguments) => global_pose::run(arguments)?,
            Self::EvalSubsets(arguments) => subsets::run(arguments)?,
            Self::Reliability(arguments) => reliability::run(arguments)?,
            Self::Doubts(arguments) => doubts::run(arguments)?,
            Self::EvalTracking(arguments) => tracking::run(arguments)?,
            Self::EvalReal(arguments) => real::run(arguments)?,
            Self::InteriorEdges(arguments) => interior_edges::run(arguments)?,
            Self::DrawTakes(arguments) => drawn_takes::run(arguments)?,
            Self::Selection(arguments) => selection::run(arguments)?,
            Self::Hypotheses(arguments) => hypotheses::run(arguments)?,
            Self::Ablation(arguments) => ablation::run(arguments)?,
            Self::Presets(arguments) => presets::run(arguments)?,
            Self::Experiment(arguments) => paper::run(arguments)?,
            Self::Report(arguments) => return page::run(arguments),
            Self::SkinModel(arguments) => skin_model::run(arguments)?,
            Self::EndModel(arguments) => end_model::run(arguments)?,
            Self::WristModel(arguments) => wrist_model::run(arguments)?,
            Self::ContactSheet(arguments) => contact_sheet::run(arguments)?,
            Self::TwoCamera(arguments) => two_camera::run(arguments)?,
            Self::Fixtures(arguments) => fixtures::run(arguments)?,
            Self::Pictures(arguments) => pictures::run(arguments)?,
            Self::BenchPeers(arguments) => peers::run(arguments)?,
            Self::Performance(arguments) => performance::run(arguments)?,
            Self::Cost(arguments) => cost::run(arguments)?,
            Self::FlatMemory(arguments) => return flat_memory::run(arguments),
        }
        Ok(ExitCode::SUCCESS)
    }
}
