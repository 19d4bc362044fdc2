//! Where the repository's files are, and writing files whole or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use image::{ImageFormat, RgbImage};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, PoseTable};

/// A path within the repository.
pub fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// Writes a file, and the folder that it is in, under another name and renames it, so that it is
/// never half-written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let partial = path.with_added_extension("partial");
    let write = || -> std::io::Result<()> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        std::fs::write(&partial, bytes)?;
        std::fs::rename(&partial, path)
    };
    write()
        .inspect_err(|_| drop(std::fs::remove_file(&partial)))
        .with_context(|| format!("writing {}", path.display()))
}

/// Writes a result to standard output.
pub fn print(result: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(result.as_bytes()).and_then(|()| out.flush()).context("writing the result")
}

/// Writes a picture as PNG, whole or not at all.
pub fn write_png(path: &Path, picture: &RgbImage) -> Result<()> {
    let mut png = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut png, ImageFormat::Png)?;
    write_whole(path, png.get_ref())
}

/// A hand from its file; the mean adult of the experiments by default.
pub fn hand(path: Option<&Path>) -> Result<HandShape> {
    let path = path.map_or_else(|| in_repository("fixtures/hand.toml"), Path::to_owned);
    HandShape::from_toml(&read_text(&path)?).with_context(|| path.display().to_string())
}

/// A rig from its file; by default that of the experiments: `side`, `top` and `other_side`.
pub fn rig(path: Option<&Path>) -> Result<Rig> {
    let path = path.map_or_else(|| in_repository("fixtures/rigs/desk.toml"), Path::to_owned);
    Rig::from_toml(&read_text(&path)?).with_context(|| path.display().to_string())
}

/// The poses of a file; what is odd about it goes to standard error.
pub fn poses(path: &Path) -> Result<PoseTable> {
    let file = std::fs::File::open(path).with_context(|| path.display().to_string())?;
    let table = PoseTable::read(file).with_context(|| path.display().to_string())?;
    for warning in &table.warnings {
        eprintln!("warning: {}: {warning}", path.display());
    }
    Ok(table)
}

fn read_text(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).with_context(|| path.display().to_string())
}
