//! The rows of a take, written as frames are answered.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use phalanx_cli::files::Output;
use phalanx_io::take::{
    CsvWriter, JsonLinesWriter, TakeFrame, TakeHeader, read_json_lines, write_npz,
};

use super::conclusion::Tally;

/// What the rows become.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Csv,
    JsonLines,
    /// Its arrays stand one after the other, so it is made of JSON Lines once all are there.
    Npz,
}

/// The rows that an earlier run wrote.
pub(super) struct Written {
    pub(super) bytes: u64,
    /// The last one's frame and time, s.
    pub(super) last: (u64, f64),
}

/// Rows on their way to an output: in a file beside it that takes its place in the end, or straight there if
/// it is no file.
pub(super) struct Rows {
    kind: Kind,
    out: Output,
    writer: Writer,
    spool: Option<Spool>,
    /// Of the frames that were written, and what could not be read.
    pub(super) tally: Tally,
}

enum Writer {
    Csv(Box<CsvWriter<Box<dyn Write>>>),
    JsonLines(Box<JsonLinesWriter<Box<dyn Write>>>),
}

/// A file that rows wait in.
struct Spool {
    file: File,
    /// `None` of a file without a name.
    path: Option<PathBuf>,
}

impl Rows {
    /// Begins them, or goes on after those that were written.
    ///
    /// # Errors
    /// Another run that writes them, and what the system says of the place.
    pub(super) fn new(
        out: &Output,
        kind: Kind,
        header: TakeHeader,
        written: Option<&Written>,
        tally: Tally,
    ) -> Result<Self> {
        let (sink, spool) = match (out.beside(".unfinished"), kind) {
            (Some(path), _) => Spool::named(path)?.open(written)?,
            (None, Kind::Npz) => Spool::nameless()?.open(written)?,
            (None, _) => (out.stream()?.context("it is a file or a stream")?, None),
        };
        let last = written.map(|written| written.last);
        let writer = match (kind, last) {
            (Kind::Csv, None) => Writer::Csv(CsvWriter::new(header, sink)?.into()),
            (Kind::Csv, Some(last)) => Writer::Csv(CsvWriter::after(header, last, sink)?.into()),
            (_, None) => Writer::JsonLines(JsonLinesWriter::new(header, sink)?.into()),
            (_, Some(last)) => {
                Writer::JsonLines(JsonLinesWriter::after(header, last, sink)?.into())
            }
        };
        Ok(Self { kind, out: out.clone(), writer, spool, tally })
    }

    /// Whether the rows that an earlier run wrote are still there.
    pub(super) fn are_there(out: &Output, bytes: u64) -> bool {
        let path = out.beside(".unfinished");
        path.and_then(|path| path.metadata().ok()).is_some_and(|file| file.len() >= bytes)
    }

    /// Writes a frame's row.
    pub(super) fn push(&mut self, frame: &TakeFrame) -> Result<()> {
        self.tally.add(frame);
        match &mut self.writer {
            Writer::Csv(rows) => rows.push(frame).and_then(|()| rows.flush())?,
            Writer::JsonLines(rows) => rows.push(frame).and_then(|()| rows.flush())?,
        }
        Ok(())
    }

    /// Waits until the rows are safe, and says how many bytes they take.
    pub(super) fn secured(&self) -> Result<u64> {
        let Some(Spool { file, .. }) = &self.spool else { return Ok(0) };
        file.sync_data()?;
        Ok(file.metadata()?.len())
    }

    /// Makes the rows the output.
    pub(super) fn finish(self) -> Result<Tally> {
        let Self { kind, out, writer, spool, tally } = self;
        drop(writer);
        let Some(Spool { mut file, path }) = spool else { return Ok(tally) };
        match (kind, path) {
            (Kind::Npz, path) => {
                file.rewind()?;
                out.write(&write_npz(&read_json_lines(BufReader::new(file))?)?)?;
                path.map_or(Ok(()), std::fs::remove_file).context("removing the rows")?;
            }
            (_, Some(path)) => out.replace_by(&path)?,
            (_, None) => {}
        }
        Ok(tally)
    }
}

impl Spool {
    /// The file of this name, which no other run may write.
    fn named(path: PathBuf) -> Result<Self> {
        let name = || path.display().to_string();
        let options =
            || OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let file = options().with_context(name)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                bail!("{}: another run is writing it", path.display())
            }
            // Some file systems have no locks.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        Ok(Self { file, path: Some(path) })
    }

    fn nameless() -> Result<Self> {
        Ok(Self { file: tempfile::tempfile()?, path: None })
    }

    /// Empty, or after what was written.
    fn open(mut self, written: Option<&Written>) -> Result<(Box<dyn Write>, Option<Self>)> {
        let bytes = written.map_or(0, |written| written.bytes);
        let opened = self.file.set_len(bytes).and_then(|()| self.file.seek(SeekFrom::End(0)));
        let handle = opened.and_then(|_| self.file.try_clone());
        let name = || self.path.as_deref().unwrap_or(Path::new("rows")).display().to_string();
        Ok((Box::new(handle.with_context(name)?), Some(self)))
    }
}
