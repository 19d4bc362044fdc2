//! How the hand is told from the rest of each camera's pictures, and its file.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::estimator::container::Container;
use crate::images::picture::Segmenter;

const FILE: Container = Container { what: "segmentation", mark: *b"PHXSEGM\0", format: 1 };

/// What tells the hand from the rest of a camera's pictures.
///
/// ```
/// use phalanx::{Segmentation, Segmenter};
/// use phalanx_segmentation::SkinModel;
///
/// let skin = Segmentation::Shared(Segmenter::Skin(SkinModel::builtin()));
/// let read = Segmentation::from_bytes(&skin.to_bytes()?)?;
/// assert!(matches!(read.of_camera("top")?, Segmenter::Skin(_)));
/// # Ok::<(), phalanx::Error>(())
/// ```
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Segmentation {
    /// The same for every camera.
    Shared(Segmenter),
    /// One for each camera, by its name.
    ByCamera(BTreeMap<String, Segmenter>),
}

impl Segmentation {
    /// What tells the hand from the rest of a camera's pictures.
    ///
    /// # Errors
    /// A camera that there is none for.
    pub fn of_camera(&self, name: &str) -> Result<&Segmenter> {
        match self {
            Self::Shared(segmenter) => Ok(segmenter),
            Self::ByCamera(cameras) => {
                cameras.get(name).ok_or_else(|| Error::NoSegmenter { camera: name.to_owned() })
            }
        }
    }

    /// The file.
    ///
    /// # Errors
    /// None that a segmentation can cause; encoding is fallible in form.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        FILE.encode(self)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// Bytes that are no segmentation, of another format, truncated, corrupt, or that contradict themselves.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        FILE.decode(bytes)
    }
}
