//! Where the repository's files are, and writing files whole or not at all.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use image::RgbImage;
use phalanx_camera::Rig;
pub use phalanx_cli::files::{Output, print};
use phalanx_hand::{HandShape, PoseTable};

/// A path within the repository.
pub fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// Writes a file whole or not at all, and makes the folder that it is in.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    output(path, &[] as &[&Path])?.write(bytes)
}

/// Writes a picture as PNG, whole or not at all.
pub fn write_png(path: &Path, picture: &RgbImage) -> Result<()> {
    output(path, &[] as &[&Path])?.write_png(picture)
}

/// The place for a result that is made of some inputs, and none of them; the folder that it is in is
/// made.
pub fn output(path: &Path, inputs: &[impl AsRef<Path>]) -> Result<Output> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    Output::new(path, inputs)
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
