//! Where a window looks, and how far it zooms.

use glam::{DVec2, DVec3};
use phalanx_camera::{Camera, Intrinsics};
use phalanx_segmentation::HandDetection;

use crate::error::{Error, Result};
use crate::features::describer::WORKING_SIZE;

/// The share of the window that the hand fills, as in the paper's data (§ 2).
const FILL: f64 = 0.2;

/// What stays free between the hand and the other borders, px.
const MARGIN: f64 = 6.0;

/// What a long thin hand leaves of the window for its arm, px.
const LEAST_ARM: f64 = 20.0;

/// The virtual camera that looks at a hand.
pub(super) fn camera(camera: &Camera, hand: &HandDetection) -> Result<Camera> {
    let view = View { camera, hand };
    let (width, height) = (f64::from(WORKING_SIZE.0), f64::from(WORKING_SIZE.1));
    let [along, across] = view.angles_per_pixel()?;
    let broad = hand.across[1] - hand.across[0];
    let filled = (FILL * width * height / (hand.area * along * across)).sqrt();
    let long = (width - MARGIN - LEAST_ARM) / (along * hand.length);
    let high = (height - 2.0 * MARGIN) / (across * broad);
    let focal = filled.min(long).min(high);
    // Window pixels per pixel of the picture.
    let scale = focal * along;
    let wrist = hand.length.min(hand.arm).min((width - MARGIN) / scale - hand.length);
    let ahead = 0.5 * width / scale - wrist;
    let middle = f64::midpoint(hand.across[0], hand.across[1]);
    let aim = view.direction(ahead, middle)?;
    let right = view.direction(ahead + 1.0, middle)? - aim;
    let inside = Intrinsics::pinhole(WORKING_SIZE.0, WORKING_SIZE.1, focal);
    let turned = camera.turned(aim, right, inside)?;
    turned.validate()?;
    Ok(turned)
}

/// A hand as a camera sees it.
struct View<'a> {
    camera: &'a Camera,
    hand: &'a HandDetection,
}

impl View<'_> {
    /// The direction in the world, a unit vector, of what is so many pixels ahead of the wrist along
    /// the arm and so many to the side.
    fn direction(&self, ahead: f64, side: f64) -> Result<DVec3> {
        let [along, wrist] = [self.hand.direction, self.hand.wrist].map(DVec2::from_array);
        let pixel = wrist + along * ahead + along.perp() * side;
        let ray = self.camera.unproject(pixel).filter(|ray| ray.direction.is_finite());
        let no_window = || Error::NoWindow { camera: self.camera.name.clone(), pixel };
        Ok(ray.ok_or_else(no_window)?.direction)
    }

    /// Radians per pixel along the arm and across it, in the middle of the hand.
    fn angles_per_pixel(&self) -> Result<[f64; 2]> {
        let reach = 0.25 * self.hand.length;
        let (ahead, side) =
            (0.5 * self.hand.length, f64::midpoint(self.hand.across[0], self.hand.across[1]));
        let angle = |da: f64, ds: f64| -> Result<f64> {
            let [from, to] =
                [self.direction(ahead - da, side - ds)?, self.direction(ahead + da, side + ds)?];
            Ok(from.angle_between(to) / (2.0 * reach))
        };
        Ok([angle(reach, 0.0)?, angle(0.0, reach)?])
    }
}
