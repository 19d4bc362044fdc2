//! What a run is made of: only the same may go on from what was broken off.

use std::fs::{File, Metadata};
use std::io::Read;
use std::path::Path;
use std::time::UNIX_EPOCH;

use anyhow::{Context, Result};
use phalanx::Maker;
use serde::{Deserialize, Serialize};

use super::arguments::Arguments;
use crate::counts::counted;
use crate::recording::landmarks::is_frame;
use crate::recording::pictures::is_picture;
use crate::recording::source::Source;
use crate::side::SideName;

/// So much of a recording is read to tell it from another, bytes; its size and the time of its last change
/// tell the rest.
const BEGINNING: u64 = 64 << 10;

/// Everything that decides the output, by name.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Identity(Vec<(String, String)>);

impl Identity {
    pub(super) fn of(arguments: &Arguments, source: &Source) -> Result<Self> {
        let segment = &arguments.recording.segment;
        let segmented = Some(segment.given().trim().to_owned()).filter(|given| !given.is_empty());
        let together = arguments.fit_together.to_string();
        let together = if arguments.whole_take { "all".to_owned() } else { together };
        let settings = [
            ("the program", Some(Maker::here().to_string())),
            ("the kind of output", Some(format!("{:?}", arguments.kind()?))),
            ("--side", Some(SideName::from(arguments.side()).to_string())),
            ("--rate", arguments.rate.map(|rate| rate.to_string())),
            ("--fit-together, --whole-take", Some(together)),
            ("--mask, --segment", segmented),
            ("--rig", Some(content(&arguments.rig)?)),
            ("--hand", arguments.hand.as_deref().map(content).transpose()?),
            ("--timestamps", arguments.recording.timestamps.as_deref().map(content).transpose()?),
            ("the file of --segment", segment.segment.as_deref().map(content).transpose()?),
        ];
        let settings = settings.into_iter().map(|(name, value)| {
            (name.to_owned(), value.unwrap_or_else(|| "not given".to_owned()))
        });
        let mut parts: Vec<(String, String)> = settings.collect();
        for (camera, path) in source.recordings() {
            let recording = recording(path).with_context(|| path.display().to_string())?;
            parts.push((format!("the recording of camera '{}'", camera.name), recording));
        }
        for path in source.landmark_paths() {
            let content = if path.is_dir() { folder(path, is_frame) } else { content(path) };
            let content = content.with_context(|| path.display().to_string())?;
            parts.push((format!("--landmarks {}", path.display()), content));
        }
        Ok(Self(parts))
    }

    /// The first thing in which an earlier one differs, in words.
    pub(super) fn difference(&self, earlier: &Self) -> Option<String> {
        let mut names = self.0.iter().chain(&earlier.0).map(|(name, _)| name.as_str());
        let name = names.find(|name| self.value(name) != earlier.value(name))?;
        Some(format!("{name} is {}, and was {}", self.value(name), earlier.value(name)))
    }

    fn value(&self, name: &str) -> &str {
        let found = self.0.iter().find(|(found, _)| found == name);
        found.map_or("absent", |(_, value)| value)
    }
}

/// A small file by its content. What is no file, such as a pipe, can be read once only.
fn content(path: &Path) -> Result<String> {
    let read = || -> std::io::Result<String> {
        if !path.is_file() {
            return Ok("no file".to_owned());
        }
        let bytes = std::fs::read(path)?;
        Ok(format!("of {} bytes with checksum {:08x}", bytes.len(), crc32fast::hash(&bytes)))
    };
    read().with_context(|| path.display().to_string())
}

/// A recording by sizes and times of change.
fn recording(path: &Path) -> Result<String> {
    let metadata = std::fs::metadata(path)?;
    if metadata.is_dir() {
        return folder(path, is_picture);
    }
    let mut beginning = Vec::new();
    if metadata.is_file() {
        File::open(path)?.take(BEGINNING).read_to_end(&mut beginning)?;
    }
    let checksum = crc32fast::hash(&beginning);
    Ok(format!("{} with checksum {checksum:08x}", size_and_time(&metadata)?))
}

/// A folder by those of its frames' files, in any order: results may be written beside them.
fn folder(path: &Path, is_of_frame: fn(&Path) -> bool) -> Result<String> {
    let (mut count, mut sum) = (0_u64, 0_u64);
    for entry in std::fs::read_dir(path)? {
        let entry = entry?;
        if !is_of_frame(&entry.path()) {
            continue;
        }
        let own = size_and_time(&std::fs::metadata(entry.path())?)?;
        let own = format!("{}: {own}", entry.file_name().to_string_lossy());
        count += 1;
        sum = sum.wrapping_add(u64::from(crc32fast::hash(own.as_bytes())));
    }
    Ok(format!("of {} with checksum {sum:x}", counted(count, "frame")))
}

fn size_and_time(metadata: &Metadata) -> Result<String> {
    let changed = metadata.modified()?.duration_since(UNIX_EPOCH).unwrap_or_default();
    let (seconds, rest) = (changed.as_secs(), changed.subsec_nanos());
    Ok(format!("of {} bytes, changed at {seconds}.{rest:09} s", metadata.len()))
}
