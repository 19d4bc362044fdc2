//! What cameras see where a hand is expected: no hand is looked for.

use phalanx_camera::Camera;
use phalanx_segmentation::{Cleanup, HandDetector, Mask};

use crate::error::{Error, Result};
use crate::fitting::observation::crop_of;
use crate::fitting::points::CameraPoints;
use crate::fitting::take_frame::TakeFrame;
use crate::localize::{BoundingSphere, HandCrop};

/// The components of a frame's masks that are as large as a hand.
pub(super) struct Seen {
    views: Vec<View>,
    /// What a detector saw, camera by camera.
    pub(super) points: Vec<Option<CameraPoints>>,
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
    /// Another number of masks or landmarks than cameras.
    pub(super) fn of(
        cameras: &[Camera],
        frame: &TakeFrame,
        finder: &mut HandDetector,
    ) -> Result<Self> {
        let TakeFrame { masks, landmarks, .. } = frame;
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
        let points = CameraPoints::of(cameras, landmarks)?;
        Ok(Self { views: cameras.iter().zip(masks).map(&mut view).collect(), points })
    }

    /// Whether no view has anything as large as a hand, nor points of one.
    pub(super) fn is_empty(&self) -> bool {
        let no_hand = self.views.iter().all(|view| view.components.is_empty());
        no_hand && self.points.iter().all(Option::is_none)
    }

    /// What each view sees of a ball in space; `None` of a view without anything like a hand there.
    pub(super) fn crops(&self, ball: BoundingSphere) -> Vec<Option<HandCrop>> {
        let crop = |view: &View| crop_of(&view.camera, view.components.iter().cloned(), ball);
        self.views.iter().map(crop).collect()
    }
}
