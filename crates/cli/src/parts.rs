//! The parts of a training that was run in shards.

use std::path::Path;

use anyhow::{Context, Result};
use phalanx::PartialTraining;

use crate::reading;

/// Reads the files of parts and merges what is in them.
///
/// # Errors
/// No file, and by its name one that cannot be read, is no part, or does not belong to the others.
pub fn merged(paths: &[impl AsRef<Path>]) -> Result<PartialTraining> {
    let mut merged: Option<PartialTraining> = None;
    for path in paths.iter().map(AsRef::as_ref) {
        let name = || path.display().to_string();
        let part = PartialTraining::from_bytes(&reading::read(path).with_context(name)?)
            .with_context(name)?;
        match &mut merged {
            None => merged = Some(part),
            Some(merged) => merged.merge(part).with_context(name)?,
        }
    }
    merged.context("there is no part")
}
