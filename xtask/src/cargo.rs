//! Running cargo.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use phalanx_lab::files;

/// The cargo that runs this command, in a folder.
pub(crate) fn cargo(folder: &Path) -> Command {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // What is compiled for one folder serves the others, if their manifests have the same profiles.
    cargo.current_dir(folder).env("CARGO_TARGET_DIR", target());
    cargo
}

/// Where cargo puts what it makes.
pub(crate) fn target() -> PathBuf {
    let folder = std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| OsString::from("target"));
    files::in_repository("").join(folder)
}

/// Runs a command that says what it has to say by itself.
pub(crate) fn run(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("{command:?}"))?;
    if !status.success() {
        bail!("failed: {command:?}");
    }
    Ok(())
}
