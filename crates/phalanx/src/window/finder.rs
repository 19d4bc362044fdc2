//! From all cameras' masks to a window on the hand in each.

use glam::DVec3;
use phalanx_camera::Camera;
use phalanx_segmentation::{Cleanup, HandDetector, Mask, Silhouette, WristModel};

use crate::error::{Error, Result};
use crate::features::describer::Describer;
use crate::window::choice;
use crate::window::virtual_camera::Window;

/// Finds the hand in all cameras' masks, one scene after another in the same memory.
#[derive(Debug, Clone, Default)]
pub struct WindowFinder {
    finders: Vec<HandDetector>,
    describer: Describer,
    seen: Mask,
}

impl WindowFinder {
    /// A window on the hand for each camera, from the cameras' masks, each a scaled copy of its
    /// camera's image. Of several things in a mask the hand is the one that looks most like a hand,
    /// is at the same place for all cameras, and is near where its wrist was in the frame before
    /// (`last`, mm in the world), if there was one.
    ///
    /// # Errors
    /// A camera without anything like a hand in its mask.
    pub fn find(
        &mut self,
        cameras: &[Camera],
        masks: &[Mask],
        last: Option<DVec3>,
    ) -> Result<Vec<Window>> {
        self.finders.resize_with(cameras.len(), HandDetector::default);
        let mut looks = Vec::with_capacity(cameras.len());
        for ((camera, mask), finder) in cameras.iter().zip(masks).zip(&mut self.finders) {
            let found = finder.find(mask, &Cleanup::default(), WristModel::builtin());
            let hands = found
                .map_err(|reason| Error::Silhouette { camera: camera.name.clone(), reason })?;
            let (width, height) = mask.dimensions();
            let pictured = camera.with_intrinsics(camera.intrinsics.resized(width, height));
            looks.push((pictured, hands));
        }
        let chosen = choice::choose(&looks, last);
        looks.iter().zip(chosen).map(|((camera, _), hand)| Window::onto(camera, &hand)).collect()
    }

    /// The silhouettes that the windows show of the hands that were found last.
    ///
    /// # Errors
    /// One without contour or forearm, as [`phalanx_segmentation::Error`] names them.
    pub fn silhouettes(
        &mut self,
        windows: &[Window],
        silhouettes: &mut [Silhouette],
    ) -> Result<()> {
        for ((window, finder), silhouette) in windows.iter().zip(&self.finders).zip(silhouettes) {
            window.resample(&finder.isolate(&window.hand), &mut self.seen);
            self.describer.silhouette_of_mask(&self.seen, silhouette).map_err(|reason| {
                Error::Silhouette { camera: window.camera.name.clone(), reason }
            })?;
        }
        Ok(())
    }
}
