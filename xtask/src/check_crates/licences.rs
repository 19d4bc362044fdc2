//! Licences and origins of all dependencies, by the lists of deny.toml, which `cargo deny check`
//! reads too. That tool also knows of published vulnerabilities, which need a database from outside.

use std::collections::BTreeMap;
use std::fmt::Write;

use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use spdx::{Expression, Licensee, ParseMode};

use super::metadata::Package;
use phalanx_lab::files;

#[derive(Deserialize)]
struct Deny {
    licenses: Licences,
}

#[derive(Deserialize)]
struct Licences {
    allow: Vec<String>,
}

pub(super) fn check(packages: &[Package]) -> Result<()> {
    let allowed = allowed()?;
    let mut problems = String::new();
    for package in packages {
        if let Err(error) = check_package(package, &allowed) {
            writeln!(problems, "{} {}: {error:#}", package.name, package.version)?;
        }
    }
    ensure!(problems.is_empty(), "dependencies that deny.toml does not allow:\n{problems}");
    for (name, versions) in duplicates(packages) {
        eprintln!("note: several versions of {name}: {}", versions.join(", "));
    }
    Ok(())
}

/// The licences on deny.toml's list.
fn allowed() -> Result<Vec<Licensee>> {
    let text = std::fs::read_to_string(files::in_repository("deny.toml")).context("deny.toml")?;
    let deny: Deny = toml::from_str(&text).context("deny.toml")?;
    let licences = deny.licenses.allow.iter();
    licences.map(|name| Licensee::parse(name).with_context(|| name.clone())).collect()
}

fn check_package(package: &Package, allowed: &[Licensee]) -> Result<()> {
    let origin = package.source.as_deref().unwrap_or("registry+");
    ensure!(origin.starts_with("registry+"), "comes from {origin}");
    let license = package.license.as_deref().context("names no licence")?;
    let expression = Expression::parse_mode(license, ParseMode::LAX)?;
    ensure!(
        expression.evaluate(|needed| allowed.iter().any(|licence| licence.satisfies(needed))),
        "licensed under {license}"
    );
    Ok(())
}

/// Packages that are there in several versions.
fn duplicates(packages: &[Package]) -> BTreeMap<&str, Vec<&str>> {
    let mut versions: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for package in packages {
        versions.entry(&package.name).or_default().push(&package.version);
    }
    versions.retain(|_, versions| versions.len() > 1);
    versions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn package(license: Option<&str>, source: Option<&str>) -> Package {
        let text = serde_json::json!({
            "name": "some", "version": "1.0.0", "license": license, "source": source,
            "publish": null, "features": {},
        });
        serde_json::from_value(text).unwrap()
    }

    #[test]
    fn one_allowed_alternative_is_enough_and_every_part_is_needed() {
        let allowed = allowed().unwrap();
        let is_fine = |license| check_package(&package(license, None), &allowed).is_ok();
        assert!(is_fine(Some("MIT")) && is_fine(Some("GPL-3.0-only OR MIT")));
        assert!(is_fine(Some("MIT/Apache-2.0")), "the old way to say or");
        assert!(!is_fine(Some("GPL-3.0-only AND MIT")) && !is_fine(Some("Proprietary")));
        assert!(!is_fine(None));
    }

    #[test]
    fn repositories_are_no_origin() {
        let allowed = allowed().unwrap();
        let cloned = package(Some("MIT"), Some("git+https://example.com/some#1"));
        assert!(check_package(&cloned, &allowed).is_err());
    }
}
