//! What `cargo metadata` knows of our packages and of those that they stand on.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail};
use serde::Deserialize;

use crate::cargo::cargo;
use phalanx_lab::files;

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
pub(super) struct Package {
    pub(super) name: String,
    pub(super) version: String,
    /// An SPDX expression.
    pub(super) license: Option<String>,
    /// Where it is from; nothing for our own.
    pub(super) source: Option<String>,
    /// The registries that it may go to: any, if nothing is said.
    publish: Option<Vec<String>>,
    pub(super) features: BTreeMap<String, Vec<String>>,
}

impl Package {
    /// Whether it is one of ours that others can depend on.
    pub(super) fn is_published(&self) -> bool {
        self.source.is_none() && self.publish.is_none()
    }
}

/// All packages of the lock file, for whatever platform.
pub(super) fn read() -> Result<Vec<Package>> {
    let mut command = cargo(&files::in_repository(""));
    command.args(["metadata", "--format-version", "1", "--locked", "--all-features"]);
    let output = command.output().context("starting cargo metadata")?;
    if !output.status.success() {
        bail!("cargo metadata: {}", String::from_utf8_lossy(&output.stderr).trim_end());
    }
    let metadata: Metadata = serde_json::from_slice(&output.stdout).context("cargo metadata")?;
    Ok(metadata.packages)
}
