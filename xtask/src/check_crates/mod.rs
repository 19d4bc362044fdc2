//! `cargo xtask check-crates`: what would trip up someone who depends on one of the crates alone.

mod features;
mod licences;
mod metadata;
mod minimal_versions;
mod packages;

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};

use metadata::Package;

#[derive(Args)]
pub(crate) struct Arguments {
    /// What is checked; everything by default.
    #[arg(value_enum)]
    checks: Vec<Check>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Check {
    /// Every dependency comes from the registry, under a licence that deny.toml allows.
    Licences,
    /// Each crate passes the lints alone, and its tests with each of its features apart.
    Features,
    /// The crates compile with the oldest dependencies that they ask for.
    MinimalVersions,
    /// `cargo publish --dry-run` has nothing to say, and what is packaged compiles with its tests.
    Packages,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let packages = metadata::read()?;
    let checks = match arguments.checks[..] {
        [] => Check::value_variants(),
        _ => &arguments.checks,
    };
    for check in checks {
        let value = check.to_possible_value().context("no check is hidden")?;
        eprintln!("checking {}", value.get_name());
        check.run(&packages).context(value.get_name().to_owned())?;
    }
    Ok(())
}

impl Check {
    fn run(self, packages: &[Package]) -> Result<()> {
        match self {
            Self::Licences => licences::check(packages),
            Self::Features => features::check(packages),
            Self::MinimalVersions => minimal_versions::check(),
            Self::Packages => packages::check(packages),
        }
    }
}
