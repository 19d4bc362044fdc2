//! Completions, manual pages and the page of all commands.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::desk::run;

const COMMANDS: [&str; 4] = ["track", "calibrate-hand", "rig-import", "completions"];

#[test]
fn every_shell_gets_completions_that_know_the_commands() {
    let folder = TempDir::new().unwrap();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let outcome = run(folder.path(), ["completions", shell]);
        assert_eq!(outcome.code, Some(0), "{}", outcome.err);
        for word in ["calibrate-hand", "track", "import", "preset"] {
            assert!(outcome.out.contains(word), "{shell}: {word}");
        }
    }
    assert_eq!(run(folder.path(), ["completions", "csh"]).code, Some(2));
}

/// Bash itself completes a command and an option's values.
#[test]
fn bash_completes() {
    let folder = TempDir::new().unwrap();
    let script = run(folder.path(), ["completions", "bash"]).out;
    let ask = "\nCOMP_WORDS=(phalanx train --preset '') COMP_CWORD=3\n_phalanx phalanx '' --preset\n\
               printf '%s ' \"${COMPREPLY[@]}\"\n";
    let bash = Command::new("bash").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
    let Ok(mut bash) = bash else {
        println!("skipped: this system has no bash");
        return;
    };
    bash.stdin.take().unwrap().write_all((script + ask).as_bytes()).unwrap();
    let output = bash.wait_with_output().unwrap();
    assert_eq!(String::from_utf8(output.stdout).unwrap().trim(), "fast default best");
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = TempDir::new().unwrap();
    let outcome = run(folder.path(), ["man", "."]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    for command in COMMANDS {
        let page = std::fs::read_to_string(folder.path().join(format!("phalanx-{command}.1")));
        let page = page.unwrap();
        assert!(page.contains(".SH SYNOPSIS") && page.contains(".SH OPTIONS"), "{command}");
    }
    let outcome = run(folder.path(), ["man", "nowhere"]);
    assert_eq!(outcome.code, Some(2));
    assert!(outcome.err.contains("nowhere: there is no such folder"), "{}", outcome.err);
    assert_eq!(run(folder.path(), ["man"]).code, Some(2));
}

#[test]
fn the_page_of_all_commands_is_as_the_program_says() {
    let folder = TempDir::new().unwrap();
    let outcome = run(folder.path(), ["man", "--markdown"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    for command in COMMANDS {
        let name = command.replacen("rig-", "rig ", 1);
        assert!(outcome.out.contains(&format!("\n## phalanx {name}\n")), "{name}");
    }
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference/commands.md");
    assert!(
        std::fs::read_to_string(page).unwrap() == outcome.out,
        "write it anew: cargo run -- man --markdown docs/reference/commands.md"
    );
}
