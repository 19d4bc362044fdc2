//! `cargo xtask layers`: whether the arrows between the files of each crate go down.
//!
//! A file imports from the files below it, and from the one that defines what it takes. Where all
//! import from the crate's root, which imports from all, no layer can be seen.

mod imports;
mod modules;

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};

use modules::Modules;
use phalanx_lab::files;

pub(crate) fn run() -> Result<()> {
    let mut problems = Vec::new();
    for folder in crates()? {
        let name = folder.file_name().context("a folder has a name")?.to_string_lossy();
        let modules = Modules::read(&folder.join("src"))?;
        let found = modules.root_imports().into_iter().chain(modules.circle());
        problems.extend(found.map(|problem| format!("{name}: {problem}")));
    }
    ensure!(problems.is_empty(), "arrows that do not go down:\n  {}", problems.join("\n  "));
    Ok(())
}

/// The folders of all crates, in order.
fn crates() -> Result<Vec<PathBuf>> {
    let mut folders = vec![files::in_repository("xtask")];
    for entry in std::fs::read_dir(files::in_repository("crates")).context("crates")? {
        folders.push(entry?.path());
    }
    folders.sort_unstable();
    Ok(folders)
}
