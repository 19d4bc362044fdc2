//! Calibrations from files.

use std::path::PathBuf;

use anyhow::{Context, Result};
use phalanx_cli::reading;
use phalanx_io::calibration::{Calibration, Missing, Source};

/// Reads the files of a calibration, which errors name.
pub(crate) fn read(paths: &[PathBuf], missing: &Missing) -> Result<Calibration> {
    let mut contents = Vec::new();
    for path in paths {
        let bytes = reading::read(path).with_context(|| path.display().to_string())?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        contents.push((name, bytes));
    }
    let files: Vec<Source<'_>> =
        contents.iter().map(|(name, bytes)| Source { name, bytes }).collect();
    Calibration::read(&files, missing).with_context(|| named(paths))
}

/// The files' paths, one after the other.
pub(crate) fn named(paths: &[PathBuf]) -> String {
    let paths: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
    paths.join(", ")
}
