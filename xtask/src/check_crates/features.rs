//! Each crate alone: in the workspace's own builds, what one crate switches on in a dependency
//! serves all the others.

use anyhow::Result;

use super::metadata::Package;
use crate::cargo::{cargo, run};
use phalanx_lab::files;

pub(super) fn check(packages: &[Package]) -> Result<()> {
    for package in packages.iter().filter(|package| package.is_published()) {
        // Without features, and with each of them alone.
        for feature in [""].into_iter().chain(package.features.keys().map(String::as_str)) {
            eprintln!("  {} {feature}", package.name);
            let with = ["--package", &package.name, "--no-default-features", "--features", feature];
            let all = ["--quiet", "--locked", "--all-targets"];
            let mut clippy = cargo(&files::in_repository(""));
            run(clippy.arg("clippy").args(all).args(with).args(["--", "-D", "warnings"]))?;
            if !package.features.is_empty() {
                let mut test = cargo(&files::in_repository(""));
                run(test.args(["test", "--quiet", "--locked"]).args(with))?;
            }
        }
    }
    Ok(())
}
