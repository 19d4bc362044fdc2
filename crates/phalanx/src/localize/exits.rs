//! Where what is seen goes on beyond the border of a picture.

use glam::{DVec2, DVec3};
use image::GrayImage;
use phalanx_camera::Camera;

use super::arm::Arm;

/// Where a mask touches the border of its camera's picture: hand or arm goes on beyond it.
#[derive(Debug, Clone)]
pub(crate) struct Exits {
    centre: DVec3,
    /// Unit directions in the world, one for each pixel.
    rays: Vec<DVec3>,
    /// The angle that a pixel is wide, radians.
    pixel: f64,
}

impl Exits {
    /// Of a mask as large as the camera's picture.
    pub(crate) fn of(camera: &Camera, mask: &GrayImage) -> Self {
        let (width, height) = mask.dimensions();
        let across = (0..width).flat_map(|x| [(x, 0), (x, height - 1)]);
        let down = (1..height.saturating_sub(1)).flat_map(|y| [(0, y), (width - 1, y)]);
        let touched = across.chain(down).filter(|&(x, y)| mask.get_pixel(x, y).0[0] > 127);
        let ray = |(x, y): (u32, u32)| {
            let middle = DVec2::new(f64::from(x), f64::from(y)) + 0.5;
            Some(camera.unproject(middle)?.direction)
        };
        let rays = touched.filter_map(ray).collect();
        Self { centre: camera.centre(), rays, pixel: camera.intrinsics.fx.recip() }
    }

    /// Adds those of another part of the same mask.
    pub(crate) fn add(&mut self, other: &Self) {
        self.rays.extend(&other.rays);
    }

    /// How wide what leaves the picture ahead of an arm's cut is, at the cut's distance, mm: of a pose that
    /// is right this is what the picture lacks of the hand. Nothing is said where the arm points at the
    /// camera or away from it.
    pub(crate) fn width_ahead_of(&self, arm: &Arm) -> f64 {
        let Some(ahead) = arm.across(self.centre) else { return 0.0 };
        let count = self.rays.iter().filter(|ray| ray.dot(ahead) > 0.0).count();
        count as f64 * self.pixel * arm.cut.distance(self.centre)
    }
}

#[cfg(test)]
mod tests {
    use image::Luma;
    use phalanx_camera::Intrinsics;

    use super::*;

    /// A camera 500 mm above the origin whose picture, 160 mm by 120 mm there, shows x to the right.
    fn above() -> Camera {
        let inside = Intrinsics::pinhole(160, 120, 500.0);
        Camera::look_at("above", inside, 500.0 * DVec3::Z, DVec3::ZERO, DVec3::Y).expect("a camera")
    }

    #[test]
    fn an_arm_may_leave_the_picture_behind_its_cut_only() {
        let camera = above();
        let right = camera.project(DVec3::X * 10.0).expect("before it").x > 80.0;
        // 20 mm wide along the picture's left border.
        let mask = GrayImage::from_fn(160, 120, |x, y| {
            Luma([if x < 100 && (50..70).contains(&y) { 255 } else { 0 }])
        });
        let exits = Exits::of(&camera, &mask);
        let to_the_right = if right { DVec3::X } else { -DVec3::X };
        let along = |direction: DVec3| Arm { cut: DVec3::ZERO, direction };
        assert_eq!(exits.width_ahead_of(&along(to_the_right)), 0.0);
        let width = exits.width_ahead_of(&along(-to_the_right));
        assert!((width - 20.0).abs() < 0.5, "{width}");
        assert_eq!(exits.width_ahead_of(&along(DVec3::Z)), 0.0, "it points at the camera");
    }
}
