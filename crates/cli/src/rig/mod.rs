//! `phalanx rig`: rigs of cameras, from other tools and for them.

pub(crate) mod calibration;
pub(crate) mod check;
mod export;
mod import;
mod locate;
mod simulation;
mod unit;
pub(crate) mod volume;

use anyhow::Result;
use clap::Subcommand;

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Make a rig file of another tool's calibration.
    Import(import::Arguments),
    /// Find out from a recording where the hand works and which way it points.
    Volume(locate::Arguments),
    /// Write a rig's cameras for another tool.
    Export(export::Arguments),
    /// Say how large a hand is in each picture, and from how different sides the cameras look.
    Check(check::Arguments),
}

pub(crate) fn run(command: &Command) -> Result<()> {
    match command {
        Command::Import(arguments) => import::run(arguments),
        Command::Volume(arguments) => locate::run(arguments),
        Command::Export(arguments) => export::run(arguments),
        Command::Check(arguments) => check::run(arguments),
    }
}
