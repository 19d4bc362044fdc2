//! Where the repository's files are, and writing files whole or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, PoseTable};

/// A path within the repository.
pub(crate) fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask is in a folder").join(path)
}

/// Writes a file under a temporary name and renames it, so that it is never half-written.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let write = || -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        let mut file = tempfile::NamedTempFile::new_in(folder)?;
        file.write_all(bytes)?;
        file.persist(path)?;
        Ok(())
    };
    write().with_context(|| format!("writing {}", path.display()))
}

/// A hand from its file; the mean adult of the experiments by default.
pub(crate) fn hand(path: Option<&Path>) -> Result<HandShape> {
    let path = path.map_or_else(|| in_repository("fixtures/hand.toml"), Path::to_owned);
    HandShape::from_toml(&read_text(&path)?).with_context(|| path.display().to_string())
}

/// A rig from its file; by default that of the experiments: `side`, `top` and `other_side`.
pub(crate) fn rig(path: Option<&Path>) -> Result<Rig> {
    let path = path.map_or_else(|| in_repository("fixtures/rigs/desk.toml"), Path::to_owned);
    Rig::from_toml(&read_text(&path)?).with_context(|| path.display().to_string())
}

/// The poses of a file; what is odd about it goes to standard error.
pub(crate) fn poses(path: &Path) -> Result<PoseTable> {
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
