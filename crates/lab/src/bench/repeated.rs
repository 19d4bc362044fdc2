//! Recordings of any length, of the demo's frames to and fro, and the program that tracks them.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::files::in_repository;

/// The program that is asked for; by default the one beside this.
pub(super) fn program(asked: Option<&Path>) -> Result<PathBuf> {
    let beside = || Ok(std::env::current_exe()?.with_file_name("phalanx"));
    asked.map_or_else(beside, |asked| Ok(std::path::absolute(asked)?))
}

/// Empties a folder and draws the demo there.
pub(super) fn drawn(program: &Path, folder: &str) -> Result<PathBuf> {
    let folder = in_repository(folder);
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    std::fs::create_dir_all(&folder)?;
    let mut demo = Command::new(program);
    let drawn = demo.args(["demo", "--out", "demo"]).current_dir(&folder).output();
    let drawn = drawn.with_context(|| format!("{} (--program)", program.display()))?;
    ensure!(drawn.status.success(), "the demo: {}", String::from_utf8_lossy(&drawn.stderr));
    Ok(folder)
}

/// Makes a recording of so many frames by some of the demo's cameras; pictures that are the same are one file.
pub(super) fn recording(folder: &Path, cameras: &[&str], frames: usize) -> Result<()> {
    let recording = folder.join("recording");
    if recording.exists() {
        std::fs::remove_dir_all(&recording)?;
    }
    for camera in cameras {
        let mut pictures = Vec::new();
        for picture in std::fs::read_dir(folder.join("demo/recording").join(camera))? {
            pictures.push(picture?.path());
        }
        pictures.sort_unstable();
        let there = pictures.iter();
        let back = pictures.iter().rev().skip(1).take(pictures.len().saturating_sub(2));
        let cycle = there.chain(back).cycle();
        std::fs::create_dir_all(recording.join(camera))?;
        for (frame, picture) in (0..frames).zip(cycle) {
            std::fs::hard_link(picture, recording.join(camera).join(format!("{frame:06}.png")))?;
        }
    }
    Ok(())
}

/// Tells the program, in that folder, to track that recording.
pub(super) fn track(program: &mut Command) -> &mut Command {
    program
        .args(["track", "--rig", "demo/rig.toml", "recording", "--mask"])
        .args(["--rate", "10", "--out", "take.csv"])
}
