//! The packages as they would be published.

use std::fmt::Write;
use std::process::Command;

use anyhow::{Context, Result, bail};

use super::metadata::Package;
use crate::cargo::{cargo, run, target};
use phalanx_lab::files;

/// What cargo always warns of at the end of a dry run.
const DRY: &str = "warning: aborting upload due to dry run";

pub(super) fn check(packages: &[Package]) -> Result<()> {
    let mut publish = cargo(&files::in_repository(""));
    // Changes need not be committed to be checked. Compiling is done below, with the tests.
    publish.args([
        "publish",
        "--dry-run",
        "--workspace",
        "--locked",
        "--allow-dirty",
        "--no-verify",
    ]);
    let output = publish.output().context("starting cargo publish")?;
    let said = String::from_utf8_lossy(&output.stderr);
    let warned = said.lines().any(|line| line.starts_with("warning:") && line != DRY);
    if warned || !output.status.success() {
        bail!("cargo publish --dry-run --workspace:\n{said}");
    }
    compile(packages)
}

/// Compiles what is in the packages, tests, examples and benchmarks too, where nothing else of the
/// repository is at hand.
fn compile(packages: &[Package]) -> Result<()> {
    let folder = target().join("packages");
    if folder.exists() {
        std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    }
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    // A dry run keeps no packages.
    let ours = || packages.iter().filter(|package| package.is_published());
    let mut archive = cargo(&files::in_repository(""));
    archive.args(["package", "--quiet", "--no-verify", "--locked", "--allow-dirty"]);
    run(archive.args(ours().flat_map(|package| ["--package", &package.name])))?;
    let mut manifest =
        String::from("[workspace]\nresolver = \"3\"\nmembers = [\"*\"]\n\n[patch.crates-io]\n");
    for package in ours() {
        let name = format!("{}-{}", package.name, package.version);
        let archive = target().join("package").join(&name).with_added_extension("crate");
        let mut unpack = Command::new("tar");
        // With the time of now, by which cargo tells what has changed: an archive gives all the same.
        run(unpack.arg("-xzmf").arg(archive).arg("-C").arg(&folder))?;
        writeln!(manifest, "{} = {{ path = \"{name}\" }}", package.name)?;
    }
    manifest += &profiles()?;
    std::fs::write(folder.join("Cargo.toml"), manifest)?;
    std::fs::copy(files::in_repository("Cargo.lock"), folder.join("Cargo.lock"))?;
    run(cargo(&folder).args(["check", "--quiet", "--workspace", "--all-targets"]))
}

/// The workspace's profiles, so that what lints have checked of others' crates is not checked again.
fn profiles() -> Result<String> {
    let manifest = std::fs::read_to_string(files::in_repository("Cargo.toml"))?;
    let mut manifest: toml::Table = toml::from_str(&manifest)?;
    manifest.retain(|section, _| section == "profile");
    Ok(format!("\n{}", toml::to_string(&manifest)?))
}
