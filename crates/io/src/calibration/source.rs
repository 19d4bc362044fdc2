//! Files as they come: bytes with a name, made text.

use crate::error::{Error, Result};

/// A file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source<'a> {
    /// Its name, without folders: cameras of files that hold one are called by it.
    pub name: &'a str,
    /// What it holds.
    pub bytes: &'a [u8],
}

impl Source<'_> {
    /// The most bytes of a file that are read. Calibrations have some kilobytes.
    const MOST_BYTES: usize = 1 << 20;

    /// The name without its extensions.
    pub(super) fn stem(&self) -> &str {
        self.name.split('.').find(|part| !part.is_empty()).unwrap_or(self.name)
    }

    /// The text, whatever it is encoded in, without a byte-order mark.
    pub(super) fn text(&self) -> Result<String> {
        let Self { bytes, .. } = *self;
        if bytes.len() > Self::MOST_BYTES {
            let megabytes = bytes.len() >> 20;
            return Err(Error::calibration(format!("{megabytes} MiB; at most 1 MiB is read")));
        }
        let text = match bytes {
            [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
            [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
            [0xef, 0xbb, 0xbf, rest @ ..] => std::str::from_utf8(rest).ok().map(str::to_owned),
            _ => std::str::from_utf8(bytes).ok().map(str::to_owned),
        };
        let text = text.ok_or_else(|| {
            Error::calibration("it is no text in UTF-8 or UTF-16: save it as UTF-8")
        })?;
        if text.trim().is_empty() {
            return Err(Error::calibration("the file is empty"));
        }
        Ok(text)
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Option<String> {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let units = pairs.iter().map(|pair| unit(*pair));
    let text = char::decode_utf16(units).collect::<std::result::Result<String, _>>().ok();
    text.filter(|_| rest.is_empty())
}
