//! The model file: a fixed header, then a postcard payload.
//!
//! | bytes | what |
//! |---|---|
//! | 0–7 | the mark `PHALANX\0` |
//! | 8–11 | format, little-endian `u32` |
//! | 12–19 | payload length, little-endian `u64` |
//! | 20–23 | CRC-32 of the payload, little-endian `u32` |
//! | 24– | payload |

use std::borrow::Cow;

use phalanx_camera::Rig;
use phalanx_hand::HandShape;
use phalanx_multiview::Concatenation;
use phalanx_rvm::{Model, ModelParts};
use serde::{Deserialize, Serialize};

use crate::{Error, Estimator, OrientationRule, Result};

const MARK: [u8; 8] = *b"PHALANX\0";
const FORMAT: u32 = 2;
const HEADER: usize = 24;

/// What the payload holds.
#[derive(Serialize, Deserialize)]
struct Payload<'a> {
    rig: Cow<'a, Rig>,
    hand: Cow<'a, HandShape>,
    orientation: OrientationRule,
    views: Cow<'a, Concatenation>,
    model: Cow<'a, ModelParts>,
}

impl Estimator {
    /// The model file's bytes.
    ///
    /// # Errors
    /// None that a fitted estimator can cause; encoding is fallible in form.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        let payload = Payload {
            rig: Cow::Borrowed(self.rig()),
            hand: Cow::Borrowed(self.hand()),
            orientation: self.orientation(),
            views: Cow::Borrowed(self.views()),
            model: Cow::Borrowed(self.model().parts()),
        };
        let payload = postcard::to_stdvec(&payload).map_err(|error| content(&error))?;
        let mut bytes = Vec::with_capacity(HEADER + payload.len());
        bytes.extend(MARK);
        bytes.extend(FORMAT.to_le_bytes());
        bytes.extend((payload.len() as u64).to_le_bytes());
        bytes.extend(crc32fast::hash(&payload).to_le_bytes());
        bytes.extend(payload);
        Ok(bytes)
    }

    /// Reads a model file's bytes.
    ///
    /// # Errors
    /// Bytes that are no model, of another format, truncated, corrupt, or whose parts do not
    /// fit each other.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let payload = checked_payload(bytes)?;
        let (payload, rest) =
            postcard::take_from_bytes::<Payload<'_>>(payload).map_err(|error| content(&error))?;
        if !rest.is_empty() {
            let reason = format!("{} bytes are left over", rest.len());
            return Err(Error::ModelContent { reason });
        }
        let Payload { rig, hand, orientation, views, model } = payload;
        let model = Model::from_parts(model.into_owned())?;
        Self::from_parts(
            rig.into_owned(),
            hand.into_owned(),
            orientation,
            views.into_owned(),
            model,
        )
    }
}

fn content(error: &postcard::Error) -> Error {
    Error::ModelContent { reason: error.to_string() }
}

/// The payload, once the header vouches for it.
fn checked_payload(bytes: &[u8]) -> Result<&[u8]> {
    let Some(rest) = bytes.strip_prefix(&MARK) else {
        return Err(Error::ForeignModel);
    };
    let too_short = || Error::ModelLength { expected: HEADER as u64, found: bytes.len() as u64 };
    let (format, rest) = rest.split_first_chunk::<4>().ok_or_else(too_short)?;
    let format = u32::from_le_bytes(*format);
    if format != FORMAT {
        return Err(Error::ModelVersion { found: format, known: FORMAT });
    }
    let (length, rest) = rest.split_first_chunk::<8>().ok_or_else(too_short)?;
    let (checksum, payload) = rest.split_first_chunk::<4>().ok_or_else(too_short)?;
    let (length, checksum) = (u64::from_le_bytes(*length), u32::from_le_bytes(*checksum));
    if payload.len() as u64 != length {
        let expected = (HEADER as u64).saturating_add(length);
        return Err(Error::ModelLength { expected, found: bytes.len() as u64 });
    }
    let found = crc32fast::hash(payload);
    if found != checksum {
        return Err(Error::ModelChecksum { expected: checksum, found });
    }
    Ok(payload)
}
