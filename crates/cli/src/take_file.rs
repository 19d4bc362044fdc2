//! Reading takes, and other files whose kind their name tells.

use std::io::BufReader;
use std::path::Path;

use anyhow::{Context, Result, bail};
use phalanx_cli::reading;
use phalanx_io::take::{
    Take, read_csv, read_json_lines, read_npz, write_csv, write_json_lines, write_npz,
};

/// What a file's name ends with, in small letters.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Reads a take: CSV, JSON Lines or NPZ by its name.
pub(crate) fn read(path: &Path) -> Result<Take> {
    let read = || -> Result<Take> {
        match extension(path).as_str() {
            "csv" => Ok(read_csv(BufReader::new(reading::open(path)?))?),
            "jsonl" => Ok(read_json_lines(BufReader::new(reading::open(path)?))?),
            "npz" => Ok(read_npz(&reading::read(path)?)?),
            _ => bail!("a take's name ends with .csv, .jsonl or .npz"),
        }
    };
    read().with_context(|| path.display().to_string())
}

/// A take as CSV, JSON Lines or NPZ, by the end of a file's name; `None` for another end.
pub(crate) fn encoded(take: &Take, kind: &str) -> Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    match kind {
        "csv" => write_csv(take, &mut bytes)?,
        "jsonl" => write_json_lines(take, &mut bytes)?,
        "npz" => bytes = write_npz(take)?,
        _ => return Ok(None),
    }
    Ok(Some(bytes))
}

/// A file's name without its folder and end.
pub(crate) fn name(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
