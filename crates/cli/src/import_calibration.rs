//! `phalanx import-calibration`: what `phalanx rig import` does, for scripts that know the older name.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use phalanx_camera::Rig;
use phalanx_cli::files::Output;
use phalanx_io::calibration::{Missing, Unit};

use crate::rig::calibration;
use crate::rig::volume::{Vector, VolumeArguments};

#[derive(Args)]
pub(crate) struct Arguments {
    /// The calibration: OpenCV's matrices and coefficients.
    #[arg(value_name = "FILE.json")]
    calibration: PathBuf,
    /// What a length of 1 is in the calibration, such as a square of the chessboard, mm.
    #[arg(long, value_name = "MM")]
    square_mm: f64,
    #[command(flatten)]
    volume: VolumeArguments,
    /// The box in which the wrist moves, mm; 300 on each side by default.
    #[arg(long, value_name = "X,Y,Z")]
    size: Option<Vector>,
    /// Where the rig goes.
    #[arg(long, value_name = "FILE.toml")]
    out: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let output = Output::new(&arguments.out, &[&arguments.calibration])?;
    let files = std::slice::from_ref(&arguments.calibration);
    let missing = Missing { unit: Some(Unit::of_mm(arguments.square_mm)?), size: None };
    let calibration = calibration::read(files, &missing)?;
    for note in &calibration.notes {
        eprintln!("note: {note}");
    }
    let named = || calibration::named(files);
    let volume = arguments.volume.of(arguments.size, calibration.volume, &calibration.cameras);
    let rig = Rig { cameras: calibration.cameras, volume: volume.with_context(named)? };
    let text = rig.to_toml().with_context(named)?;
    rig.view_scales().with_context(named)?;
    output.write(text.as_bytes())
}
