//! `cargo xtask skin-model`: trains the skin model that the segmentation crate ships.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::Args;
use phalanx_segmentation::{BUILTIN_SOURCE, Label, SkinTrainer};

use crate::files;

#[derive(Args)]
pub struct Arguments {
    /// The folder of data; its `skin-pixels/Skin_NonSkin.txt` is read: rows of blue, green, red
    /// and 1 for skin or 2 for other pixels.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Where the model goes; the file that the crate ships by default.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let path = arguments.data.join("skin-pixels/Skin_NonSkin.txt");
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let mut trainer = SkinTrainer::default();
    let mut counts = [0_usize; 2];
    for (number, line) in text.lines().enumerate().skip(1) {
        let (rgb, label) = pixel(line)
            .with_context(|| format!("{}: line {}: '{line}'", path.display(), number + 1))?;
        counts[usize::from(label == Label::NonSkin)] += 1;
        trainer.add_pixel(rgb, label);
    }
    let bytes = trainer.finish(BUILTIN_SOURCE)?.to_bytes();
    let shipped = files::in_repository("crates/segmentation/models/skin.txt");
    let out = arguments.out.clone().unwrap_or(shipped);
    files::write_whole(&out, &bytes)?;
    let [skin, other] = counts;
    files::print(&format!("{}: {skin} skin and {other} other pixels\n", out.display()))
}

/// A row of the file: colour and class.
fn pixel(line: &str) -> Result<([u8; 3], Label)> {
    let mut cells = line.split_whitespace();
    let mut level = || -> Result<u8> { Ok(cells.next().context("too few columns")?.parse()?) };
    let [blue, green, red, class] = [level()?, level()?, level()?, level()?];
    match class {
        1 => Ok(([red, green, blue], Label::Skin)),
        2 => Ok(([red, green, blue], Label::NonSkin)),
        other => bail!("class {other} is neither 1 nor 2"),
    }
}
