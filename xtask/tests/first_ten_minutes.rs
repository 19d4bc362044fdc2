//! A stranger's first ten minutes with each library: a fresh crate outside the workspace that depends
//! on it by path, with the README's examples in it as printed. The repository's README comes last.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is compiled for one crate is kept for the next.
const SHARED: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/first-ten-minutes");

/// The folders of the libraries, those that others stand on first.
const LIBRARIES: [&str; 10] = [
    "shape-context",
    "codebook",
    "hand",
    "camera",
    "segmentation",
    "rvm",
    "render",
    "multiview",
    "refine",
    "phalanx",
];

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask is in a folder").to_owned()
}

/// A README's example.
struct Example {
    code: String,
    /// Whether it reads files that a stranger has not got.
    only_compiles: bool,
}

/// The examples of a README, as rustdoc would see them.
fn examples(readme: &str) -> Vec<Example> {
    let mut found = Vec::new();
    let mut lines = readme.lines();
    while let Some(line) = lines.next() {
        let Some(attributes) = line.strip_prefix("```rust") else { continue };
        let mut code = String::new();
        for line in lines.by_ref().take_while(|line| *line != "```") {
            code += match line {
                "#" => "",
                _ => line.strip_prefix("# ").unwrap_or(line),
            };
            code += "\n";
        }
        found.push(Example { code, only_compiles: attributes.contains("no_run") });
    }
    found
}

/// A program of an example: rustdoc, too, puts code without a main function into one.
fn program(code: &str) -> String {
    if code.contains("fn main()") {
        return code.to_owned();
    }
    let (kind, end) = if code.trim_end().ends_with("(())") {
        (" -> Result<(), impl std::fmt::Debug>", "example().unwrap()")
    } else {
        ("", "example()")
    };
    format!("fn main() {{\nfn example(){kind} {{\n{code}}}\n{end}\n}}\n")
}

/// The crates that code names, as dependencies: ours by path, others as in the workspace.
fn dependencies(code: &str, library: &str) -> String {
    let workspace = std::fs::read_to_string(repository().join("Cargo.toml")).expect("a manifest");
    let roots = code.match_indices("::").filter_map(|(at, _)| {
        let word = code[..at].rsplit(|c: char| !(c.is_alphanumeric() || c == '_')).next()?;
        Some(word.replace('_', "-"))
    });
    let mut names: Vec<String> = roots.chain([library.to_owned()]).collect();
    names.sort_unstable();
    names.dedup();
    let mut text = String::new();
    for name in names {
        let entry = workspace.lines().find(|line| line.starts_with(&format!("{name} = ")));
        let Some(entry) = entry else { continue };
        let line = match entry.split_once("path = \"") {
            Some((_, rest)) => {
                let folder = rest.split('"').next().unwrap_or_default();
                format!("{name} = {{ path = '{}' }}", repository().join(folder).display())
            }
            None => entry.to_owned(),
        };
        writeln!(text, "{line}").expect("a string takes everything");
    }
    text
}

/// Makes the stranger's crate, and compiles and runs what is in it.
fn try_out(library: &str, readme: &str, home: &Path) {
    let text = std::fs::read_to_string(repository().join(readme)).expect("a README");
    let examples = examples(&text);
    assert!(!examples.is_empty(), "{readme} has no example");
    std::fs::create_dir_all(home.join("src/bin")).expect("a folder");
    let all: String = examples.iter().map(|example| example.code.as_str()).collect();
    let manifest = format!(
        "[package]\nname = \"stranger\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n\
         [dependencies]\n{}",
        dependencies(&all, library)
    );
    std::fs::write(home.join("Cargo.toml"), manifest).expect("a manifest");
    // The versions that are at hand, so that nothing has to be fetched.
    std::fs::copy(repository().join("Cargo.lock"), home.join("Cargo.lock")).expect("a lock file");
    for (number, example) in examples.iter().enumerate() {
        let name = format!("example{number}");
        let path = home.join("src/bin").join(&name).with_added_extension("rs");
        std::fs::write(path, program(&example.code)).expect("a program");
        let verb = if example.only_compiles { "build" } else { "run" };
        let mut cargo = Command::new(env!("CARGO"));
        cargo.current_dir(home).env("CARGO_TARGET_DIR", SHARED);
        let output = cargo.args([verb, "--offline", "--quiet", "--bin", &name]).output();
        let output = output.expect("cargo starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{readme}, example {number}:\n{said}");
    }
}

#[test]
#[ignore = "compiles every crate afresh, which takes minutes; .ci/run asks for it"]
fn every_readme_runs_as_printed() {
    let scratch = std::env::temp_dir().join(format!("phalanx-stranger-{}", std::process::id()));
    for folder in LIBRARIES {
        let library = match folder {
            "phalanx" => folder.to_owned(),
            _ => format!("phalanx-{folder}"),
        };
        try_out(&library, &format!("crates/{folder}/README.md"), &scratch.join(folder));
    }
    try_out("phalanx", "README.md", &scratch.join("repository"));
    std::fs::remove_dir_all(&scratch).expect("the scratch folder goes away");
}

#[test]
fn examples_are_found_and_wrapped_like_rustdocs() {
    let readme = "text\n```rust\nuse a::B;\n# Ok::<(), a::Error>(())\n```\n```console\n$ no\n```\n\
                  ```rust,no_run\nfn main() {}\n```\n";
    let found = examples(readme);
    assert_eq!(found.len(), 2);
    assert!(!found[0].only_compiles && found[1].only_compiles);
    assert_eq!(found[0].code, "use a::B;\nOk::<(), a::Error>(())\n");
    assert!(program(&found[0].code).contains("-> Result<(), impl std::fmt::Debug>"));
    assert_eq!(program(&found[1].code), "fn main() {}\n");
}
