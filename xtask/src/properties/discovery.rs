//! Finding the property tests of the workspace.

use std::collections::BTreeSet;
use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

use crate::cargo::cargo;
use phalanx_lab::files;

/// A test that draws its cases at random.
pub(super) struct Property {
    /// Its package's.
    pub(super) folder: PathBuf,
    /// How cargo is told of its program: `--lib` or `--test NAME`.
    target: String,
    /// As its program knows it.
    pub(super) name: String,
    pub(super) program: PathBuf,
}

/// As arguments of `cargo test --manifest-path`.
impl Display for Property {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let folder = self.folder.strip_prefix(files::in_repository("")).unwrap_or(&self.folder);
        write!(f, "{}/Cargo.toml {} {}", folder.display(), self.target, self.name)
    }
}

/// What cargo says of each thing that it made.
#[derive(Deserialize)]
struct Artifact {
    manifest_path: PathBuf,
    target: Target,
    executable: Option<PathBuf>,
}

#[derive(Deserialize)]
struct Target {
    kind: Vec<String>,
    name: String,
}

/// Compiles all tests and lists those that are properties.
pub(super) fn find() -> Result<Vec<Property>> {
    let mut build = cargo(&files::in_repository(""));
    build.args(["test", "--workspace", "--no-run", "--locked", "--quiet"]);
    build.args(["--lib", "--tests", "--message-format", "json-render-diagnostics"]);
    let output = build.stderr(Stdio::inherit()).output().context("starting cargo")?;
    ensure!(output.status.success(), "the tests do not compile");
    let said = String::from_utf8(output.stdout).context("cargo's list")?;
    // Other messages lack what an artifact has.
    let artifacts = said.lines().filter_map(|line| serde_json::from_str::<Artifact>(line).ok());
    let mut properties = Vec::new();
    for artifact in artifacts {
        properties.extend(properties_of(artifact)?);
    }
    properties.sort_by_key(ToString::to_string);
    Ok(properties)
}

fn properties_of(artifact: Artifact) -> Result<Vec<Property>> {
    let Some(program) = artifact.executable else { return Ok(Vec::new()) };
    let target = match artifact.target.kind.first().map(String::as_str) {
        Some("lib") => "--lib".to_owned(),
        Some("test") => format!("--test {}", artifact.target.name),
        _ => return Ok(Vec::new()),
    };
    let folder = artifact.manifest_path.parent().context("a manifest is in a folder")?.to_owned();
    let mut names = BTreeSet::new();
    for path in sources(&folder)? {
        let source = std::fs::read_to_string(&path);
        names.extend(names_in(&source.with_context(|| path.display().to_string())?));
    }
    let list = Command::new(&program).args(["--list", "--format", "terse"]).output();
    let list = String::from_utf8(list.context("listing tests")?.stdout).context("a test's name")?;
    let tests = list.lines().filter_map(|line| line.strip_suffix(": test"));
    let is_property = |test: &&str| test.rsplit("::").next().is_some_and(|t| names.contains(t));
    Ok(tests
        .filter(is_property)
        .map(|name| Property {
            folder: folder.clone(),
            target: target.clone(),
            name: name.to_owned(),
            program: program.clone(),
        })
        .collect())
}

/// All Rust files of a folder.
fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut sources = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            sources.extend(self::sources(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            sources.push(path);
        }
    }
    Ok(sources)
}

/// The names of the functions within `proptest!`.
fn names_in(source: &str) -> Vec<String> {
    let mut names = Vec::new();
    // The line that closes the macro that we are in.
    let mut closing = None;
    for line in source.lines() {
        let text = line.trim_start();
        if text == "proptest! {" {
            closing = Some(format!("{}}}", &line[..line.len() - text.len()]));
        } else if closing.as_deref() == Some(line) {
            closing = None;
        } else if let (Some(_), Some(function)) = (&closing, text.strip_prefix("fn ")) {
            names.extend(function.split('(').next().map(str::to_owned));
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::{files, names_in, sources};

    #[test]
    fn every_property_is_the_same_in_every_run() {
        for path in sources(&files::in_repository("crates")).unwrap() {
            let source = std::fs::read_to_string(&path).unwrap();
            for (_, block) in source.match_indices("proptest! {").map(|(at, _)| source.split_at(at))
            {
                let head = block.lines().nth(1).unwrap_or_default();
                assert!(
                    head.contains("#![proptest_config(") && head.contains("property::cases("),
                    "{}: {head}",
                    path.display()
                );
            }
        }
    }

    #[test]
    fn properties_are_what_the_macro_holds() {
        let source = "
fn helper() {}

    proptest! {
        #[test]
        fn one(seed: u64) {
        }

        #[test]
        fn other(
            seed in 0..9,
        ) {
        }
    }

    #[test]
    fn no_property() {}
";
        assert_eq!(names_in(source), ["one", "other"]);
    }
}
