//! What is kept of a training, for the case that it is broken off.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use phalanx::{Error, PartialTraining};
use phalanx_cli::files::Output;

/// Keeping takes at most one part in so many of the time: a part may have a hundred megabytes.
const SHARE: u32 = 20;

/// A file beside the output, there only while a training is unfinished.
pub(crate) struct Checkpoint {
    /// Nothing where the output is no file.
    path: Option<PathBuf>,
    kept: Instant,
    /// How long it took to keep the last one.
    took: Duration,
}

impl Checkpoint {
    /// The checkpoint of what becomes this output.
    pub(crate) fn beside(out: &Output) -> Self {
        let path = out.is_file().then(|| {
            let mut name = out.path().as_os_str().to_owned();
            name.push(".unfinished");
            PathBuf::from(name)
        });
        Self { path, kept: Instant::now(), took: Duration::ZERO }
    }

    /// What an earlier run left. One that cannot be read is said, and the training begins anew.
    pub(crate) fn read(&self) -> Option<PartialTraining> {
        let path = self.path.as_deref()?;
        let bytes = std::fs::read(path).ok()?;
        let part = PartialTraining::from_bytes(&bytes);
        part.inspect_err(|error| {
            eprintln!("phalanx: {}: {error}; the training begins anew", path.display());
        })
        .ok()
    }

    /// Keeps the part unless the last one is new. A training goes on without.
    pub(crate) fn keep(&mut self, part: &PartialTraining) {
        let Some(path) = &self.path else { return };
        if self.kept.elapsed() < SHARE * self.took {
            return;
        }
        let begun = Instant::now();
        if let Err(error) = write(path, part) {
            eprintln!("phalanx: what is done is not kept: {error:#}");
        }
        (self.took, self.kept) = (begun.elapsed(), Instant::now());
    }

    /// An error of a training that went on; that of another one says which file to remove.
    pub(crate) fn explained(&self, error: Error) -> anyhow::Error {
        match (&error, &self.path) {
            (Error::ForeignPart { .. }, Some(path)) => anyhow::anyhow!(
                "{}: an unfinished training with other settings ({error}); finish it, or remove the file",
                path.display()
            ),
            _ => error.into(),
        }
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

fn write(path: &Path, part: &PartialTraining) -> anyhow::Result<()> {
    Output::new(path, &[] as &[&Path])?.write(&part.to_bytes()?)
}
