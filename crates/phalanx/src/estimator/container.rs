//! Files: a fixed header, then a postcard payload.
//!
//! | bytes | what |
//! |---|---|
//! | 0–7 | the mark |
//! | 8–11 | format, little-endian `u32` |
//! | 12–19 | payload length, little-endian `u64` |
//! | 20–23 | CRC-32 of the payload, little-endian `u32` |
//! | 24– | payload |

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

const HEADER: usize = 24;

/// A kind of file.
pub(crate) struct Container {
    /// What error messages call it.
    pub(crate) what: &'static str,
    pub(crate) mark: [u8; 8],
    pub(crate) format: u32,
}

impl Container {
    /// The file's bytes. The payload is written behind the header, and not copied there: a part of a training may
    /// have a gigabyte.
    pub(crate) fn encode(&self, payload: &impl Serialize) -> Result<Vec<u8>> {
        let header = vec![0; HEADER];
        let mut bytes =
            postcard::to_extend(payload, header).map_err(|error| self.content(&error))?;
        let (header, payload) = bytes.split_at_mut(HEADER);
        let (mark, numbers) = header.split_at_mut(self.mark.len());
        mark.copy_from_slice(&self.mark);
        numbers[..4].copy_from_slice(&self.format.to_le_bytes());
        numbers[4..12].copy_from_slice(&(payload.len() as u64).to_le_bytes());
        numbers[12..].copy_from_slice(&crc32fast::hash(payload).to_le_bytes());
        Ok(bytes)
    }

    /// What a file's bytes hold.
    ///
    /// # Errors
    /// Bytes of something else, of another format, truncated or corrupt.
    pub(crate) fn decode<'a, T: Deserialize<'a>>(&self, bytes: &'a [u8]) -> Result<T> {
        let payload = self.payload(bytes)?;
        let (decoded, rest) =
            postcard::take_from_bytes(payload).map_err(|error| self.content(&error))?;
        if !rest.is_empty() {
            let reason = format!("{} bytes are left over", rest.len());
            return Err(Error::FileContent { what: self.what, reason });
        }
        Ok(decoded)
    }

    fn content(&self, error: &postcard::Error) -> Error {
        Error::FileContent { what: self.what, reason: error.to_string() }
    }

    /// The payload, once the header vouches for it.
    fn payload<'a>(&self, bytes: &'a [u8]) -> Result<&'a [u8]> {
        let Self { what, format: known, .. } = *self;
        let Some(rest) = bytes.strip_prefix(&self.mark) else {
            return Err(Error::ForeignFile { what });
        };
        let length = |expected| Error::FileLength { what, expected, found: bytes.len() as u64 };
        let too_short = || length(HEADER as u64);
        let (format, rest) = rest.split_first_chunk::<4>().ok_or_else(too_short)?;
        let found = u32::from_le_bytes(*format);
        if found != known {
            return Err(Error::FileVersion { what, found, known });
        }
        let (announced, rest) = rest.split_first_chunk::<8>().ok_or_else(too_short)?;
        let (checksum, payload) = rest.split_first_chunk::<4>().ok_or_else(too_short)?;
        let (announced, expected) = (u64::from_le_bytes(*announced), u32::from_le_bytes(*checksum));
        if payload.len() as u64 != announced {
            return Err(length((HEADER as u64).saturating_add(announced)));
        }
        let found = crc32fast::hash(payload);
        if found != expected {
            return Err(Error::FileChecksum { what, expected, found });
        }
        Ok(payload)
    }
}
