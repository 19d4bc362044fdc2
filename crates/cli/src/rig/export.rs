//! `phalanx rig export`.

use std::path::PathBuf;

use anyhow::Result;
use clap::{Args, ValueEnum};
use phalanx_cli::files::Output;
use phalanx_io::calibration::{to_anipose_toml, to_opencv_yaml};

use crate::rig::check;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The rig.
    #[arg(value_name = "RIG.toml")]
    rig: PathBuf,
    /// For which tool.
    #[arg(long)]
    format: Format,
    /// Where the calibration goes, in millimetres; `-`, standard output, by default.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// Anipose's calibration.toml, which Caliscope, Pose2Sim and aniposelib read, too.
    Anipose,
    /// OpenCV's FileStorage in YAML, with the names of keys that EasyMocap uses.
    Opencv,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let out = arguments.out.as_deref().unwrap_or("-".as_ref());
    let out = Output::new(out, &[&arguments.rig])?;
    let cameras = check::read(&arguments.rig)?.cameras;
    let text = match arguments.format {
        Format::Anipose => to_anipose_toml(&cameras),
        Format::Opencv => to_opencv_yaml(&cameras),
    };
    out.write(text.as_bytes())
}
