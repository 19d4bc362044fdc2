//! What is kept of long work, for the case that it is broken off.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Result;
use phalanx_cli::files::Output;

/// Keeping takes at most one part in so many of the time: a training may have a hundred megabytes.
const SHARE: u32 = 20;

/// A file beside the output, there only while the work is unfinished.
pub(crate) struct Checkpoint {
    /// Nothing where the output is no file.
    path: Option<PathBuf>,
    kept: Instant,
    /// How long it took to keep the last one.
    took: Duration,
    /// Whether it was said that nothing can be kept.
    is_said: bool,
}

impl Checkpoint {
    /// The checkpoint of what becomes this output: the file of its name with `end` after it.
    pub(crate) fn beside(out: &Output, end: &str) -> Self {
        let (kept, took) = (Instant::now(), Duration::ZERO);
        Self { path: out.beside(end), kept, took, is_said: false }
    }

    pub(crate) fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// What an earlier run left, and where.
    pub(crate) fn read(&self) -> Option<(&Path, Vec<u8>)> {
        let path = self.path()?;
        Some((path, std::fs::read(path).ok()?))
    }

    /// Keeps what `bytes` makes, unless the last one is new. The work goes on without.
    pub(crate) fn keep(&mut self, bytes: impl FnOnce() -> Result<Vec<u8>>) {
        let Some(path) = &self.path else { return };
        if self.kept.elapsed() < SHARE * self.took {
            return;
        }
        let begun = Instant::now();
        if let Err(error) = bytes().and_then(|bytes| write(path, &bytes))
            && !std::mem::replace(&mut self.is_said, true)
        {
            eprintln!("phalanx: what is done is not kept: {error:#}");
        }
        (self.took, self.kept) = (begun.elapsed(), Instant::now());
    }

    /// Removes it.
    pub(crate) fn remove(&self) {
        if let Some(path) = &self.path
            && path.exists()
            && let Err(error) = std::fs::remove_file(path)
        {
            eprintln!("phalanx: {}: {error}", path.display());
        }
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    Output::new(path, &[] as &[&Path])?.write(bytes)
}
