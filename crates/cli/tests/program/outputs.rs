//! Where results go: every kind of place keeps what it is, and nothing is lost or half-written.

use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

use crate::calibrations::CALIBRATION;
use crate::desk::{CAMERAS, Desk, Outcome, run};
use crate::tracks::recorded;

/// A folder with a calibration to import.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("c.json"), CALIBRATION).unwrap();
    folder
}

const IMPORT: [&str; 5] = ["import-calibration", "c.json", "--square-mm", "50", "--out"];

/// Imports the calibration to a place.
fn import(folder: &Path, out: &str) -> Outcome {
    run(folder, IMPORT.iter().chain(&[out]))
}

/// The rig file that is written.
fn rig_file() -> String {
    let folder = folder();
    assert_eq!(import(folder.path(), "rig.toml").code, Some(0));
    std::fs::read_to_string(folder.path().join("rig.toml")).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_dash_is_standard_output() {
    let folder = folder();
    let outcome = import(folder.path(), "-");
    assert_eq!((outcome.code, outcome.out), (Some(0), rig_file()));
    assert_eq!(names(folder.path()), ["c.json"]);
}

#[test]
fn an_overlay_on_standard_output_leaves_the_estimate_to_standard_error() {
    let desk = Desk::new();
    let mut program = Command::new(env!("CARGO_BIN_EXE_phalanx"));
    let pictures = ["--mask", "side-mask.png", "top-mask.png"];
    program.current_dir(desk.folder()).args(["estimate", "--model", "model", "--overlay", "-"]);
    let output = program.args(pictures).output().unwrap();
    assert!(output.status.success());
    assert!(image::load_from_memory(&output.stdout).is_ok(), "a picture and nothing else");
    assert!(String::from_utf8(output.stderr).unwrap().contains("index.mcp"));
}

#[test]
fn an_input_is_no_output() {
    let desk = Desk::new();
    let pictures = ["--mask", "side-mask.png", "top-mask.png", "--overlay"];
    let before = desk.read("side-mask.png");
    std::fs::hard_link(desk.path("side-mask.png"), desk.path("other.png")).unwrap();
    for name in ["side-mask.png", "./side-mask.png", "other.png"] {
        let outcome = desk.estimate(&[pictures.as_slice(), &[name]].concat());
        assert_eq!((outcome.code, outcome.out.as_str()), (Some(2), ""));
        assert!(outcome.err.contains("this is the input side-mask.png"), "{}", outcome.err);
    }
    assert_eq!(desk.read("side-mask.png"), before);
    let folder = folder();
    let outcome = import(folder.path(), "c.json");
    assert_eq!(outcome.code, Some(2), "{}", outcome.err);
    assert_eq!(std::fs::read_to_string(folder.path().join("c.json")).unwrap(), CALIBRATION);
}

/// Most commands are given the pictures by their folder, or by the names of cameras.
#[test]
fn a_picture_that_is_read_is_no_output() {
    let desk = recorded(4);
    let [picture, other] = CAMERAS.map(|camera| format!("take/{camera}/0001.png"));
    let before = desk.read(&picture);
    let named = [format!("{}={picture}", CAMERAS[0]), format!("{}={other}", CAMERAS[1])];
    for arguments in [
        &["calibrate-hand", "--model", "model", "--frames", "take", "--mask", "--out"][..],
        &["skin", "--empty", "take", "--out"],
        &["rig", "volume", "rig.toml", "take", "--mask", "--out"],
        &["track", "--rig", "rig.toml", "--mask", "take", "--out", "a.csv", "--save-hand"],
        &["estimate", "--model", "model", "--mask", &named[0], &named[1], "--overlay"],
    ] {
        let outcome = run(desk.folder(), arguments.iter().chain(&[&*picture]));
        assert_eq!(outcome.code, Some(2), "{arguments:?}");
        assert!(outcome.err.contains(&format!("{picture}: this is the input")), "{outcome:?}");
    }
    assert_eq!(desk.read(&picture), before);
}

#[test]
fn two_results_have_two_places() {
    let desk = recorded(2);
    for (out, hand) in [("a.csv", "./a.csv"), ("-", "-")] {
        let track = ["track", "--rig", "rig.toml", "--mask", "take", "--out", out, "--save-hand"];
        let outcome = run(desk.folder(), track.iter().chain(&[hand]));
        assert_eq!((outcome.code, outcome.out.as_str()), (Some(2), ""));
        assert!(outcome.err.contains("another result goes there"), "{}", outcome.err);
        assert!(!desk.path("a.csv").exists());
    }
}

#[test]
fn what_cannot_be_a_file_is_named() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("inner")).unwrap();
    for (out, part) in [
        ("inner", "this is a folder"),
        ("nowhere/rig.toml", "there is no folder nowhere"),
        ("..", "this is a folder"),
    ] {
        let outcome = import(folder.path(), out);
        assert_eq!(outcome.code, Some(2));
        assert!(outcome.err.contains(part), "no '{part}' in: {}", outcome.err);
    }
}

/// The estimate is as good without the picture of it.
#[test]
fn an_overlay_that_cannot_be_written_is_a_doubt() {
    if !Path::new("/dev/full").exists() {
        println!("skipped: this system has no /dev/full");
        return;
    }
    let desk = Desk::new();
    let pictures = ["--mask", "side-mask.png", "top-mask.png", "--overlay", "/dev/full"];
    let outcome = desk.estimate(&[pictures.as_slice(), &["--json"]].concat());
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    assert!(outcome.err.contains("there is no overlay: writing /dev/full"), "{}", outcome.err);
    let result: serde_json::Value = serde_json::from_str(&outcome.out).unwrap();
    let doubts = result["doubts"].as_array().unwrap();
    assert!(doubts.iter().any(|doubt| doubt["cause"] == "no_overlay"));
}

#[cfg(unix)]
mod unix {
    use std::io::Read;
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
    use std::os::unix::process::CommandExt;

    use super::*;

    #[test]
    fn links_are_followed_also_to_what_is_not_there_yet() {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("inner")).unwrap();
        symlink("inner/rig.toml", at("new")).unwrap();
        symlink("new", at("again")).unwrap();
        for link in ["again", "new"] {
            assert_eq!(import(folder.path(), link).code, Some(0));
            assert!(at(link).symlink_metadata().unwrap().is_symlink());
            assert_eq!(std::fs::read_to_string(at("inner/rig.toml")).unwrap(), rig_file());
            assert_eq!(names(&at("inner")), ["rig.toml"]);
        }
        symlink("round", at("around")).unwrap();
        symlink("around", at("round")).unwrap();
        let outcome = import(folder.path(), "round");
        assert!(outcome.err.contains("without end"), "{}", outcome.err);
        symlink("c.json", at("input")).unwrap();
        assert_eq!(import(folder.path(), "input").code, Some(2));
    }

    #[test]
    fn a_pipe_and_a_device_are_written_through() {
        let folder = folder();
        let pipe = folder.path().join("pipe");
        if !Command::new("mkfifo").arg(&pipe).status().is_ok_and(|status| status.success()) {
            println!("skipped: this system has no mkfifo");
            return;
        }
        let reader = std::thread::spawn(move || {
            let mut text = String::new();
            std::fs::File::open(pipe).unwrap().read_to_string(&mut text).unwrap();
            text
        });
        assert_eq!(import(folder.path(), "pipe").code, Some(0));
        assert_eq!(reader.join().unwrap(), rig_file());
        assert_eq!(import(folder.path(), "/dev/null").code, Some(0));
        assert!(!Path::new("/dev/null").metadata().unwrap().is_file());
        assert_eq!(names(folder.path()), ["c.json", "pipe"]);
    }

    #[test]
    fn mode_and_hard_links_are_kept() {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("rig.toml"), "old").unwrap();
        std::fs::set_permissions(at("rig.toml"), PermissionsExt::from_mode(0o600)).unwrap();
        assert_eq!(import(folder.path(), "rig.toml").code, Some(0));
        assert_eq!(at("rig.toml").metadata().unwrap().mode() & 0o777, 0o600);
        for old in ["short", &"long ".repeat(10_000)] {
            std::fs::write(at("rig.toml"), old).unwrap();
            std::fs::hard_link(at("rig.toml"), at("twin")).unwrap();
            assert_eq!(import(folder.path(), "rig.toml").code, Some(0));
            assert_eq!(
                at("rig.toml").metadata().unwrap().ino(),
                at("twin").metadata().unwrap().ino()
            );
            assert_eq!(std::fs::read_to_string(at("twin")).unwrap(), rig_file());
            std::fs::remove_file(at("twin")).unwrap();
        }
        std::fs::set_permissions(at("rig.toml"), PermissionsExt::from_mode(0o444)).unwrap();
        let outcome = import(folder.path(), "rig.toml");
        assert_eq!(outcome.code, Some(2));
        assert!(outcome.err.contains("read-only"), "{}", outcome.err);
    }

    /// Files may not grow, as on a full disk.
    #[test]
    fn a_full_disk_is_named_and_nothing_is_lost() {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("old.toml"), "old").unwrap();
        std::fs::write(at("linked.toml"), "old").unwrap();
        std::fs::hard_link(at("linked.toml"), at("twin")).unwrap();
        let before = names(folder.path());
        for out in ["new.toml", "old.toml", "linked.toml"] {
            let limited = "trap '' XFSZ; ulimit -f 0; exec \"$0\" \"$@\"";
            let mut shell = Command::new("sh");
            shell.current_dir(folder.path()).args(["-c", limited, env!("CARGO_BIN_EXE_phalanx")]);
            let outcome = Outcome::from(shell.args(IMPORT).arg(out).output().unwrap());
            assert_eq!(outcome.code, Some(2));
            assert!(outcome.err.contains(&format!("writing {out}: ")), "{}", outcome.err);
            assert_eq!(names(folder.path()), before, "nothing is half-written");
        }
        for name in ["old.toml", "linked.toml"] {
            assert_eq!(std::fs::read_to_string(at(name)).unwrap(), "old");
        }
    }

    #[test]
    fn a_folder_that_may_not_be_written_to_is_named() {
        /// A user with no rights, on most systems.
        const NOBODY: u32 = 65_534;
        let folder = folder();
        let readable = PermissionsExt::from_mode(0o555);
        std::fs::set_permissions(folder.path(), readable).unwrap();
        let mut program = Command::new(env!("CARGO_BIN_EXE_phalanx"));
        program.current_dir(folder.path()).args(IMPORT).arg("rig.toml");
        if folder.path().metadata().unwrap().uid() == 0 {
            program.uid(NOBODY).gid(NOBODY);
        }
        let output = program.output();
        std::fs::set_permissions(folder.path(), PermissionsExt::from_mode(0o755)).unwrap();
        let Ok(output) = output else {
            println!("skipped: the program cannot be run as an unprivileged user");
            return;
        };
        let outcome = Outcome::from(output);
        assert_eq!(outcome.code, Some(2), "{}", outcome.err);
        assert!(outcome.err.contains("writing rig.toml: folder .: "), "{}", outcome.err);
        assert_eq!(names(folder.path()), ["c.json"]);
    }
}
