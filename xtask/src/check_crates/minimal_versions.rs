//! The crates with the oldest dependencies that their manifests ask for.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::cargo::{cargo, run, target};
use phalanx_lab::files;

/// Resolves and compiles in a copy, whose lock file is its own.
pub(super) fn check() -> Result<()> {
    let copy = target().join("minimal-versions");
    if copy.exists() {
        std::fs::remove_dir_all(&copy).with_context(|| copy.display().to_string())?;
    }
    for path in tracked()? {
        copy_file(&path, &copy)?;
    }
    // The option is not stable. It is cargo's alone: what is compiled, the stable compiler compiles.
    let mut resolve = cargo(&copy);
    resolve.args(["generate-lockfile", "--quiet", "-Z", "direct-minimal-versions"]);
    run(resolve.env("RUSTC_BOOTSTRAP", "1"))?;
    run(cargo(&copy).args(["check", "--quiet", "--locked", "--workspace", "--all-features"]))
}

/// The files that make up the libraries and the program.
fn tracked() -> Result<Vec<String>> {
    let mut git = Command::new("git");
    git.current_dir(files::in_repository("")).args(["ls-files", "-z", "Cargo.toml", "crates"]);
    let output = git.output().context("starting git")?;
    ensure!(output.status.success(), "git: {}", String::from_utf8_lossy(&output.stderr));
    let list = String::from_utf8(output.stdout).context("a path")?;
    Ok(list.split_terminator('\0').map(str::to_owned).collect())
}

fn copy_file(path: &str, folder: &Path) -> Result<()> {
    let (from, to) = (files::in_repository(path), folder.join(path));
    if from.is_dir() {
        return Ok(()); // a link to a folder of fixtures
    }
    std::fs::create_dir_all(to.parent().context("a file is in a folder")?)?;
    if path == "Cargo.toml" {
        return std::fs::write(&to, without_xtask(&std::fs::read_to_string(&from)?)?)
            .context("writing the copy's manifest");
    }
    std::fs::copy(&from, &to).with_context(|| path.to_owned())?;
    Ok(())
}

/// The workspace without the chores, on whose dependencies nobody depends.
fn without_xtask(manifest: &str) -> Result<String> {
    let mut manifest: toml::Table = toml::from_str(manifest)?;
    let workspace = manifest.get_mut("workspace").and_then(toml::Value::as_table_mut);
    let members = vec![toml::Value::from("crates/*")];
    workspace.context("no workspace")?.insert("members".to_owned(), members.into());
    Ok(toml::to_string(&manifest)?)
}
