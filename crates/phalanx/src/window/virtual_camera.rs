//! A window: a virtual camera turned and zoomed onto a hand.

use glam::DVec2;
use phalanx_camera::{Camera, PixelMap};
use phalanx_refine::SilhouetteObservation;
use phalanx_segmentation::{HandDetection, Mask, Silhouette};

use crate::error::Result;
use crate::features::describer::WORKING_SIZE;
use crate::window::layout;
use crate::window::resample::PixelPlaces;

/// A virtual camera of [`WORKING_SIZE`](crate::WORKING_SIZE), turned and zoomed onto a hand so that
/// it fills a fifth of the picture. The arm comes from the left border, at most one hand length
/// behind the wrist: all that is further back is outside the picture, and no contour.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// The virtual camera, at the real one's place.
    pub camera: Camera,
    /// The hand in the real camera's picture, px.
    pub hand: HandDetection,
    /// From the window's pixels to the picture's.
    to_picture: PixelMap,
    /// The real camera, with pixels as the picture has them.
    pictured: Camera,
}

/// A hand found in a picture, with the camera whose pixels are that picture's: pictures may have another
/// size than the rig says, so that pixels alone mean nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct PicturedHand {
    /// The camera, with pixels as the picture has them.
    pub camera: Camera,
    /// The hand, px.
    pub hand: HandDetection,
}

impl Window {
    /// The window on a hand in a camera's picture.
    ///
    /// # Errors
    /// A hand so near the picture's border that the lens has no place for its window.
    pub fn onto(camera: &Camera, hand: &HandDetection) -> Result<Self> {
        let virtual_camera = layout::camera(camera, hand)?;
        let to_picture = PixelMap::between(&virtual_camera, camera);
        Ok(Self { camera: virtual_camera, hand: *hand, to_picture, pictured: camera.clone() })
    }

    /// The picture's width and height, px.
    pub fn picture(&self) -> (u32, u32) {
        (self.pictured.intrinsics.width, self.pictured.intrinsics.height)
    }

    /// The hand in the picture.
    pub fn pictured_hand(&self) -> PicturedHand {
        PicturedHand { camera: self.pictured.clone(), hand: self.hand }
    }

    /// A mask of the picture as the window shows it: 255 where at least half of a pixel is hand.
    pub fn resample(&self, mask: &Mask, seen: &mut Mask) {
        if seen.dimensions() != WORKING_SIZE {
            *seen = Mask::new(WORKING_SIZE.0, WORKING_SIZE.1);
        }
        self.places().resample(mask, seen);
    }

    /// What its silhouette tells of the pose; of what is beyond the picture's border, nothing.
    ///
    /// # Errors
    /// A silhouette of another size than the window, or without a border.
    pub fn evidence(&self, silhouette: &Silhouette) -> Result<SilhouetteObservation> {
        let places = self.places();
        let inside = places.inside(self.picture());
        let known = |at: DVec2| inside.is_hand(at.x as u32, at.y as u32);
        let evidence = SilhouetteObservation::within(&self.camera, &silhouette.mask, known)?;
        Ok(evidence.resampled(1.0 / places.pixels_aside()))
    }

    fn places(&self) -> PixelPlaces {
        PixelPlaces::new(&self.to_picture, WORKING_SIZE)
    }

    /// The picture's pixel for one of the window; `None` where the picture's lens has none.
    pub fn to_picture(&self, pixel: [f64; 2]) -> Option<[f64; 2]> {
        self.to_picture.map(DVec2::from_array(pixel)).map(DVec2::into)
    }
}
