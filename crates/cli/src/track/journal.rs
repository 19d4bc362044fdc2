//! What is kept of a hand that is being tracked, so that a run that was broken off goes on.

use std::path::Path;

use anyhow::{Context, Result, bail};
use phalanx::TrackerState;
use phalanx_cli::files::Output;
use phalanx_hand::HandShape;
use serde::{Deserialize, Serialize};

use super::conclusion::Tally;
use super::identity::Identity;
use crate::checkpoint::Checkpoint;

/// How far a run was.
#[derive(Serialize, Deserialize)]
pub(super) struct Point {
    /// The person's hand, as it is written.
    pub(super) hand: HandShape,
    /// The tracker's before it was given the frame of `moment`.
    pub(super) tracker: TrackerState,
    /// The last moment that was read. All frames before it were answered and written.
    pub(super) moment: usize,
    /// So many bytes the rows take.
    pub(super) bytes: u64,
    pub(super) tally: Tally,
}

/// `OUT.checkpoint`: a line of JSON that says which run it is of, and where the run was.
pub(super) struct Journal {
    identity: Identity,
    checkpoint: Checkpoint,
}

impl Journal {
    pub(super) fn beside(out: &Output, identity: Identity) -> Self {
        Self { identity, checkpoint: Checkpoint::beside(out, ".checkpoint") }
    }

    /// Where an earlier run was broken off. What cannot be read is said, and the run begins anew.
    ///
    /// # Errors
    /// A run of something else.
    pub(super) fn read(&self) -> Result<Option<Point>> {
        let Some((path, bytes)) = self.checkpoint.read() else { return Ok(None) };
        let Some((identity, point)) = parts(&bytes) else {
            eprintln!("phalanx: {}: it cannot be read; all begins anew", path.display());
            return Ok(None);
        };
        self.check(path, &identity)?;
        let point = postcard::from_bytes(point);
        Ok(Some(point.with_context(|| format!("{}: it is damaged; remove it", path.display()))?))
    }

    /// Refuses a run of something else, and says of what.
    fn check(&self, path: &Path, earlier: &Identity) -> Result<()> {
        let Some(difference) = self.identity.difference(earlier) else { return Ok(()) };
        bail!(
            "{}: a run of something else was broken off here: {difference}; finish it as it was, or remove the \
             file to begin anew",
            path.display()
        )
    }

    /// Keeps where the run is, now and then.
    pub(super) fn keep(&mut self, point: impl FnOnce() -> Result<Point>) {
        let identity = &self.identity;
        self.checkpoint.keep(|| {
            let mut bytes = serde_json::to_vec(identity)?;
            bytes.push(b'\n');
            bytes.extend(postcard::to_stdvec(&point()?)?);
            Ok(bytes)
        });
    }

    pub(super) fn remove(&self) {
        self.checkpoint.remove();
    }
}

fn parts(bytes: &[u8]) -> Option<(Identity, &[u8])> {
    let end = bytes.iter().position(|&byte| byte == b'\n')?;
    let (identity, point) = bytes.split_at(end);
    Some((serde_json::from_slice(identity).ok()?, &point[1..]))
}
