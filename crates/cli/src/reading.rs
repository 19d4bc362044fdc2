//! Reading files that have an end.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Opens a file or a pipe.
///
/// # Errors
/// A device, of which there may be no end; what the system says of the file.
pub fn open(path: &Path) -> Result<File> {
    let file = File::open(path)?;
    if is_device(&file.metadata()?) {
        let what = "this is a device, which may have no end; name a file";
        return Err(Error::new(ErrorKind::InvalidInput, what));
    }
    Ok(file)
}

/// Reads the whole of a file or a pipe.
///
/// # Errors
/// As of [`open`].
pub fn read(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads the whole of a file or a pipe as text.
///
/// # Errors
/// As of [`open`], and what is not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    std::io::read_to_string(open(path)?)
}

#[cfg(unix)]
fn is_device(file: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = file.file_type();
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: &Metadata) -> bool {
    false
}
