//! Drawn hands as windows show them, without the pictures that the windows look into.

use phalanx_camera::{Camera, Intrinsics, PixelMap};
use phalanx_hand::Primitive;
use phalanx_render::Renderer;
use phalanx_segmentation::{Cleanup, Mask, Silhouette, Workspace, clean_into, downsample_mask};

use crate::error::{Error, Result};
use crate::features::describer::{Describer, WORKING_SIZE};
use crate::synthesis::augmentation::make_ragged;
use crate::window::finder::WindowFinder;
use crate::window::resample::{PixelPlaces, pixels_aside};
use crate::window::virtual_camera::Window;

/// The longest side of a picture in which hands are found, px: a [`HandDetector`] looks at no more than
/// 200 cells along a hand and its arm.
///
/// [`HandDetector`]: phalanx_segmentation::HandDetector
const FINDING: u32 = 320;

/// The most of a picture's pixels along a side of a window's pixel: what is ragged in finer ones no
/// longer shows.
const MOST_PIXELS: f64 = 3.0;

/// A window is drawn at (4, 3) pixels times a number, so that it keeps its shape.
const SHAPE: (u32, u32) = (4, 3);

/// What one camera sees of a scene.
pub(crate) struct DrawnView {
    /// The hand, in the world as the camera sees it.
    pub(crate) solids: Vec<Primitive>,
    /// The seed of a ragged border.
    pub(crate) ragged: Option<u64>,
}

/// Sees drawn hands through windows, one scene after another in the same memory. It finds the hand in
/// small pictures, and draws what a window shows in pixels as wide as those of the camera's picture:
/// borders are ragged by those, and cleaned by those. So its cost does not depend on the picture's size.
#[derive(Debug, Clone, Default)]
pub(crate) struct DrawnWindows {
    cameras: Vec<Camera>,
    /// For the small pictures.
    renderers: Vec<Renderer>,
    small: Vec<Mask>,
    finder: WindowFinder,
    drawn: Mask,
    cleaned: Mask,
    cleaning: Workspace,
    describer: Describer,
}

impl DrawnWindows {
    /// # Errors
    /// A camera that cannot draw.
    pub(crate) fn new(cameras: &[Camera]) -> Result<Self> {
        let renderer = |camera: &Camera| renderer(camera, small(&camera.intrinsics));
        Ok(Self {
            cameras: cameras.to_vec(),
            renderers: cameras.iter().map(renderer).collect::<Result<_>>()?,
            small: vec![Mask::default(); cameras.len()],
            ..Self::default()
        })
    }

    /// The silhouettes of a scene, one for each camera, and the windows that show them.
    ///
    /// # Errors
    /// A view that cannot be drawn, or shows no hand.
    pub(crate) fn silhouettes(
        &mut self,
        views: &[DrawnView],
        silhouettes: &mut [Silhouette],
    ) -> Result<Vec<Window>> {
        let windows = self.find(views)?;
        let shown = windows.iter().zip(views).zip(silhouettes).enumerate();
        for (number, ((window, view), silhouette)) in shown {
            let seen = self.draw(number, window, view)?;
            self.describer
                .silhouette_of_mask(&seen, silhouette)
                .map_err(|reason| no_silhouette(&window.camera, reason))?;
        }
        Ok(windows)
    }

    /// The windows onto the pictures of the cameras, found in small ones.
    fn find(&mut self, views: &[DrawnView]) -> Result<Vec<Window>> {
        let cameras = self.cameras.iter().zip(&mut self.renderers).zip(&mut self.small);
        for (((camera, renderer), small), view) in cameras.zip(views) {
            renderer
                .silhouette_into(&view.solids, small)
                .map_err(|reason| Error::Render { camera: camera.name.clone(), reason })?;
            let is_whole = camera.intrinsics.width == small.width();
            if let Some(seed) = view.ragged.filter(|_| is_whole) {
                make_ragged(small, seed);
            }
        }
        self.finder.find(&self.cameras, &self.small, None)
    }

    /// The mask of [`WORKING_SIZE`] that a window onto the picture of a camera shows.
    fn draw(&mut self, number: usize, window: &Window, view: &DrawnView) -> Result<Mask> {
        let camera = &self.cameras[number];
        let aside = pixels_aside(&PixelMap::between(&window.camera, camera), WORKING_SIZE);
        let aside = aside.min(MOST_PIXELS);
        let times = (f64::from(WORKING_SIZE.0 / SHAPE.0) * aside).round().max(1.0) as u32;
        let fine = window.camera.intrinsics.resized(SHAPE.0 * times, SHAPE.1 * times);
        renderer(&window.camera, fine)?
            .silhouette_into(&view.solids, &mut self.drawn)
            .map_err(|reason| Error::Render { camera: camera.name.clone(), reason })?;
        if let Some(seed) = view.ragged {
            make_ragged(&mut self.drawn, seed);
        }
        let Intrinsics { width, height, .. } = camera.intrinsics;
        let to_picture = PixelMap::between(&window.camera.with_intrinsics(fine), camera);
        PixelPlaces::new(&to_picture, self.drawn.dimensions())
            .cut(&mut self.drawn, (width, height));
        clean_into(&self.drawn, &Cleanup::default(), &mut self.cleaning, &mut self.cleaned)
            .and_then(|()| downsample_mask(&self.cleaned, WORKING_SIZE.0, WORKING_SIZE.1))
            .map_err(|reason| no_silhouette(camera, reason))
    }
}

/// Of the same shape, no longer than [`FINDING`].
fn small(intrinsics: &Intrinsics) -> Intrinsics {
    let longest = intrinsics.width.max(intrinsics.height);
    let side = |side: u32| (side * FINDING).div_ceil(longest);
    if longest <= FINDING {
        return *intrinsics;
    }
    intrinsics.resized(side(intrinsics.width), side(intrinsics.height))
}

fn renderer(camera: &Camera, intrinsics: Intrinsics) -> Result<Renderer> {
    Renderer::new(&camera.with_intrinsics(intrinsics))
        .map_err(|reason| Error::Render { camera: camera.name.clone(), reason })
}

fn no_silhouette(camera: &Camera, reason: phalanx_segmentation::Error) -> Error {
    Error::Silhouette { camera: camera.name.clone(), reason }
}
