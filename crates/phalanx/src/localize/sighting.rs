//! What one camera knows of where a hand is: the ray of its wrist and the plane of its arm.

use glam::{DVec2, DVec3};
use phalanx_camera::{Camera, Ray};
use phalanx_segmentation::HandDetection;

use crate::error::{Error, Result};

/// A hand in one camera's picture.
#[derive(Clone, Copy)]
pub(crate) struct Sighting<'a> {
    pub(crate) camera: &'a Camera,
    pub(crate) hand: &'a HandDetection,
    pub(crate) wrist: Ray,
    /// Normal of the plane through the camera in which the arm lies: the camera sees the hand's end
    /// of it turned about the normal from the wrist.
    normal: DVec3,
}

impl<'a> Sighting<'a> {
    /// # Errors
    /// A wrist where the camera's lens maps nothing.
    pub(crate) fn new(camera: &'a Camera, hand: &'a HandDetection) -> Result<Self> {
        let ray = |pixel: DVec2| {
            let no_window = || Error::NoWindow { camera: camera.name.clone(), pixel };
            camera.unproject(pixel).ok_or_else(no_window)
        };
        let [at, along] = [hand.wrist, hand.direction].map(DVec2::from_array);
        let wrist = ray(at)?;
        let ahead = ray(at + along * (0.5 * hand.width))?;
        let normal = wrist.direction.cross(ahead.direction).normalize_or_zero();
        Ok(Self { camera, hand, wrist, normal })
    }

    /// The direction to which the arm goes in the picture, as far as it is across the view.
    pub(crate) fn across(&self) -> DVec3 {
        self.normal.cross(self.wrist.direction)
    }

    /// The direction in the plane of the arm that is nearest to `rest`, and goes the way that is seen.
    pub(crate) fn in_plane(&self, rest: DVec3) -> DVec3 {
        let flat = rest - self.normal * rest.dot(self.normal);
        let flat = flat.normalize_or(self.across());
        if flat.dot(self.across()) < 0.0 { self.across() } else { flat }
    }

    /// How far an arm of unit length in a direction is seen from where the picture shows it.
    pub(crate) fn miss(&self, arm: DVec3) -> f64 {
        let seen = arm - self.wrist.direction * arm.dot(self.wrist.direction);
        seen.distance(self.across() * seen.length())
    }

    /// How wide the wrist is if it is at a point of the world, mm; 0 behind the camera, which sees nothing
    /// there.
    pub(crate) fn width_mm(&self, wrist: DVec3) -> f64 {
        let depth = self.camera.extrinsics.to_camera(wrist).z.max(0.0);
        self.hand.width * depth / self.camera.intrinsics.fx
    }
}

/// The arm's direction, in the world: where the planes of several sightings meet. Each pair of planes
/// says so with the sine of their angle; nothing where all are within a degree of parallel.
pub(crate) fn arm(sightings: &[Sighting<'_>]) -> Option<DVec3> {
    let mut sum = DVec3::ZERO;
    for (k, first) in sightings.iter().enumerate() {
        for second in &sightings[k + 1..] {
            let meet = first.normal.cross(second.normal);
            let sense = meet.dot(first.across()) + meet.dot(second.across());
            sum += meet * sense.signum();
        }
    }
    (sum.length() > 0.02).then(|| sum.normalize())
}
