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

/// Crates that do not keep to this yet, each of which is to leave this list.
const NOT_YET: [&str; 1] = ["phalanx"];

pub(crate) fn run() -> Result<()> {
    let mut problems = Vec::new();
    for folder in crates()? {
        let name = folder.file_name().context("a folder has a name")?.to_string_lossy();
        let modules = Modules::read(&folder.join("src"))?;
        let found: Vec<String> =
            modules.root_imports().into_iter().chain(modules.circle()).collect();
        match (NOT_YET.contains(&&*name), found.is_empty()) {
            (false, _) => problems.extend(found.iter().map(|problem| format!("{name}: {problem}"))),
            (true, false) => eprintln!("{name}: {} problems, known", found.len()),
            (true, true) => eprintln!("{name}: no problem; take it from NOT_YET"),
        }
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
