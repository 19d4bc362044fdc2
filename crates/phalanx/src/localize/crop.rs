//! What a camera sees of a hand in space.

use glam::{DVec2, DVec3};
use phalanx_camera::{Camera, Intrinsics, PixelMap};
use phalanx_refine::SilhouetteObservation;
use phalanx_segmentation::Mask;

use super::arm::Arm;
use super::exits::Exits;
use crate::error::{Error, Result};
use crate::window::resample::PixelPlaces;

/// Side of a crop, px: with [`REACH`] a pixel is about two millimetres of an adult's hand, a quarter of
/// a finger.
const SIDE: u32 = 128;

/// Least of the depth of a hand's middle that is in front of it: a camera within the hand sees nothing.
const NEAREST: f64 = 1.05;

/// A ball that a hand fits into.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingSphere {
    /// Its middle, mm in the world.
    pub middle: DVec3,
    /// Its radius, mm.
    pub radius: f64,
}

/// A camera's mask seen through a virtual camera at the same place, turned and zoomed onto a ball in
/// space: also where the camera itself found no hand.
#[derive(Debug, Clone)]
pub struct HandCrop {
    /// The virtual camera, square.
    pub camera: Camera,
    /// 255 where the mask covers at least half of a pixel.
    pub mask: Mask,
    /// 255 where the picture reaches.
    inside: Mask,
    /// How many of the picture's pixels one of the crop's is wide.
    grain: f64,
    /// Where what is seen leaves the picture.
    pub(crate) exits: Exits,
}

impl HandCrop {
    /// A crop of a mask that `camera` sees, whose image must be as large as the mask.
    ///
    /// # Errors
    /// A ball that is not before the camera.
    pub fn onto(camera: &Camera, mask: &Mask, ball: BoundingSphere) -> Result<Self> {
        let offset = ball.middle - camera.centre();
        let in_camera = camera.extrinsics.to_camera(ball.middle);
        if in_camera.z <= 0.0 {
            return Err(Error::BehindCamera { camera: camera.name.clone() });
        }
        let distance = offset.length().max(NEAREST * ball.radius);
        let tangent = ball.radius / (distance.powi(2) - ball.radius.powi(2)).sqrt();
        let focal = f64::from(SIDE) / 2.0 / tangent;
        let right = camera.extrinsics.rotation.row(0);
        let virtual_camera =
            camera.turned(offset, right, Intrinsics::pinhole(SIDE, SIDE, focal))?;
        let to_picture = PixelMap::between(&virtual_camera, camera);
        let places = PixelPlaces::new(&to_picture, (SIDE, SIDE));
        let mut seen = Mask::new(SIDE, SIDE);
        places.resample(mask, &mut seen);
        Ok(Self {
            inside: places.inside(mask.dimensions()),
            grain: places.pixels_aside(),
            exits: Exits::of(camera, mask),
            camera: virtual_camera,
            mask: seen,
        })
    }

    /// How many of the crop's pixels the mask fills.
    pub(crate) fn filled(&self) -> u32 {
        self.mask.area() as u32
    }

    /// Whether the ball holds most of a mask of the picture.
    pub(crate) fn holds_most_of(&self, mask: &Mask) -> bool {
        let all = mask.area() as f64;
        f64::from(self.filled()) * self.grain * self.grain > 0.5 * all
    }

    /// Adds what another crop onto the same ball sees.
    pub(crate) fn add(&mut self, other: &Self) {
        self.mask.iter_mut().zip(other.mask.iter()).for_each(|(own, other)| *own |= other);
        self.exits.add(&other.exits);
    }

    /// What it tells of a hand whose arm is known no further than said.
    ///
    /// # Errors
    /// A mask without a border that is known.
    pub fn evidence(&self, arm: &Arm) -> Result<SilhouetteObservation> {
        let hidden = arm.seen_by(&self.camera).hidden(&self.mask);
        let known = |at: DVec2| {
            let (x, y) = (at.x as u32, at.y as u32);
            self.inside.is_hand(x, y) && !hidden.is_hand(x, y)
        };
        let evidence = SilhouetteObservation::within(&self.camera, &self.mask, known)?;
        Ok(evidence.resampled(1.0 / self.grain))
    }
}
