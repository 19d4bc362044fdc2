//! The model file.

use std::borrow::Cow;

use phalanx_camera::Rig;
use phalanx_hand::HandShape;
use phalanx_multiview::Concatenation;
use phalanx_rvm::{Model, ModelParts};
use serde::{Deserialize, Serialize};

use crate::container::Container;
use crate::{Description, Estimator, Result};

const MODEL: Container = Container { what: "model", mark: *b"PHALANX\0", format: 3 };

/// What the payload holds.
#[derive(Serialize, Deserialize)]
struct Payload<'a> {
    rig: Cow<'a, Rig>,
    hand: Cow<'a, HandShape>,
    description: Description,
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
            description: self.description(),
            views: Cow::Borrowed(self.views()),
            model: Cow::Borrowed(self.model().parts()),
        };
        MODEL.encode(&payload)
    }

    /// Reads a model file's bytes.
    ///
    /// # Errors
    /// Bytes that are no model, of another format, truncated, corrupt, or whose parts do not
    /// fit each other.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let Payload { rig, hand, description, views, model } = MODEL.decode(bytes)?;
        let model = Model::from_parts(model.into_owned())?;
        Self::from_parts(
            rig.into_owned(),
            hand.into_owned(),
            description,
            views.into_owned(),
            model,
        )
    }
}
