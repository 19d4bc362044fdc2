//! What cameras see where a hand is expected: no hand is looked for.

use phalanx_camera::Camera;
use phalanx_segmentation::{Cleanup, HandDetector, Mask};

use crate::fitting::observation::crop_of;
use crate::localize::{BoundingSphere, HandCrop};
use crate::{Error, Result};

/// The components of a frame's masks that are as large as a hand.
pub(super) struct Seen {
    views: Vec<View>,
}

struct View {
    /// The camera, its image as large as the mask.
    camera: Camera,
    components: Vec<Mask>,
}

impl Seen {
    /// In the masks of a frame, one for each camera, of any size.
    ///
    /// # Errors
    /// Another number of masks than cameras.
    pub(super) fn of(
        cameras: &[Camera],
        masks: &[Option<Mask>],
        finder: &mut HandDetector,
    ) -> Result<Self> {
        if masks.len() != cameras.len() {
            let cameras = cameras.iter().map(|camera| camera.name.clone()).collect();
            return Err(Error::PictureCount { cameras, found: masks.len() });
        }
        let mut view = |(camera, mask): (&Camera, &Option<Mask>)| {
            let Some(mask) = mask else {
                return View { camera: camera.clone(), components: Vec::new() };
            };
            let (width, height) = mask.dimensions();
            // A mask without a hand is an answer, not an error.
            let components = finder.components(mask, &Cleanup::default()).unwrap_or_default();
            View {
                camera: camera.with_intrinsics(camera.intrinsics.resized(width, height)),
                components,
            }
        };
        Ok(Self { views: cameras.iter().zip(masks).map(&mut view).collect() })
    }

    /// Whether no view has anything as large as a hand.
    pub(super) fn is_empty(&self) -> bool {
        self.views.iter().all(|view| view.components.is_empty())
    }

    /// What each view sees of a ball in space; `None` of a view without anything like a hand there.
    pub(super) fn crops(&self, ball: BoundingSphere) -> Vec<Option<HandCrop>> {
        let crop = |view: &View| crop_of(&view.camera, view.components.iter().cloned(), ball);
        self.views.iter().map(crop).collect()
    }
}
