//! How far an arm is known.

use glam::{DVec2, DVec3};
use image::Luma;
use phalanx_camera::Camera;
use phalanx_segmentation::Mask;

/// An arm: from where on, behind the wrist, nothing is known of it. It may go on, end in a sleeve or
/// at a cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arm {
    /// The point of its axis up to which it is known, mm in the world.
    pub cut: DVec3,
    /// Unit vector along it towards the hand.
    pub direction: DVec3,
}

/// How wide a sleeve may be about the arm's axis, mm: the half width of the mean forearm's thick end
/// and half as much again.
const SLEEVE: f64 = 66.0;
/// How far behind the cut an arm is looked for, mm: a forearm's length.
const FAR: f64 = 250.0;
/// Sine of the angle between arm and view from which on all behind the cut is arm: where the arm is
/// seen more from the side than from its end.
const SIDEWAYS: f64 = 0.5;

/// How far beside what is seen its background is known, px: borders have a pixel of it on their other side.
const BESIDE: u32 = 2;

/// The part of a camera's picture in which nothing is known because of an arm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Covered {
    cut: DVec2,
    far: DVec2,
    /// Half widths at both, px.
    widths: [f64; 2],
    /// Whether all that lies behind the cut is covered, however far aside.
    is_half_plane: bool,
}

impl Arm {
    /// Its direction as it looks from a point: the part across the view of its cut; `None` where it is
    /// seen more from its end than from the side.
    pub(super) fn across(&self, from: DVec3) -> Option<DVec3> {
        let view = (self.cut - from).normalize_or(DVec3::Z);
        let across = self.direction.reject_from_normalized(view);
        (across.length() > SIDEWAYS).then_some(across)
    }

    /// What it covers in a camera's picture.
    pub(super) fn seen_by(&self, camera: &Camera) -> Covered {
        let width = |at: DVec3| {
            let depth = camera.extrinsics.to_camera(at).z;
            SLEEVE * camera.intrinsics.fx / depth.max(1.0)
        };
        let mut reach = FAR;
        // An arm that comes from behind the camera is followed as far as it is before it.
        let far = loop {
            let at = self.cut - self.direction * reach;
            if let Some(pixel) =
                camera.project(at).filter(|_| camera.extrinsics.to_camera(at).z > 10.0)
            {
                break (pixel, width(at));
            }
            reach *= 0.5;
            if reach < 1.0 {
                let end = camera.project(self.cut).unwrap_or(DVec2::ZERO);
                break (end, width(self.cut));
            }
        };
        Covered {
            cut: camera.project(self.cut).unwrap_or(far.0),
            far: far.0,
            widths: [width(self.cut), far.1],
            is_half_plane: self.across(camera.centre()).is_some(),
        }
    }
}

impl Covered {
    /// Where nothing is known in a mask: all that is covered, but for what is seen there apart from the arm, such as a
    /// thumb that points back, and what is next to that.
    pub(super) fn hidden(&self, mask: &Mask) -> Mask {
        let (width, height) = mask.dimensions();
        let middle = |x: u32, y: u32| DVec2::new(f64::from(x), f64::from(y)) + 0.5;
        let covered = Mask::from_fn(width, height, |x, y| self.covers(middle(x, y)));
        let seen = |x: u32, y: u32| covered.is_hand(x, y) && mask.is_hand(x, y);
        let apart = without_connected(Mask::from_fn(width, height, seen), |x, y| {
            self.aside(middle(x, y)) < 1.0
        });
        if apart.area() == 0 {
            return covered;
        }
        let is_next_to = |x: u32, y: u32| {
            let mut near = near(x, y, BESIDE, mask.dimensions());
            near.any(|(x, y)| apart.is_hand(x, y))
        };
        let is_hidden = |x: u32, y: u32| {
            let is_arm = seen(x, y) && !apart.is_hand(x, y);
            covered.is_hand(x, y) && (is_arm || !is_next_to(x, y))
        };
        Mask::from_fn(width, height, is_hidden)
    }

    /// How far aside of the arm's axis a pixel is, px.
    fn aside(&self, pixel: DVec2) -> f64 {
        let along = (self.far - self.cut).normalize_or_zero();
        along.perp_dot(pixel - self.cut).abs()
    }

    /// Whether a pixel is behind where the arm is cut, and may be of it.
    fn covers(&self, pixel: DVec2) -> bool {
        let (along, offset) = (self.far - self.cut, pixel - self.cut);
        let length = along.length();
        if length < 1e-6 {
            return offset.length() < self.widths[0];
        }
        let ahead = offset.dot(along) / length;
        if self.is_half_plane {
            return ahead > 0.0;
        }
        let share = (ahead / length).clamp(0.0, 1.0);
        let width = self.widths[0] + share * (self.widths[1] - self.widths[0]);
        ahead > 0.0 && (offset - along * share).length() < width
    }
}

/// A mask without the components that hold a pixel of some.
fn without_connected(mut mask: Mask, is_held: impl Fn(u32, u32) -> bool) -> Mask {
    let size = mask.dimensions();
    let all = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
    let mut front: Vec<(u32, u32)> =
        all.filter(|&(x, y)| mask.is_hand(x, y) && is_held(x, y)).collect();
    while let Some((x, y)) = front.pop() {
        if mask.is_hand(x, y) {
            mask.put_pixel(x, y, Luma([0]));
            front.extend(near(x, y, 1, size));
        }
    }
    mask
}

/// The pixels that are at most so many columns and rows away from one.
fn near(
    x: u32,
    y: u32,
    away: u32,
    (width, height): (u32, u32),
) -> impl Iterator<Item = (u32, u32)> {
    let rows = y.saturating_sub(away)..=(y + away).min(height - 1);
    rows.flat_map(move |y| {
        (x.saturating_sub(away)..=(x + away).min(width - 1)).map(move |x| (x, y))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thumb_beside_an_arm_is_known_and_the_arm_is_not() {
        let covered = Covered {
            cut: DVec2::new(20.0, 30.0),
            far: DVec2::new(20.0, 300.0),
            widths: [30.0; 2],
            is_half_plane: true,
        };
        // A palm above the cut, its arm below, a thumb that points down beside it.
        let mask = Mask::from_fn(50, 60, |x, y| {
            let arm = (12..28).contains(&x);
            let thumb = (34..40).contains(&x) && (20..45).contains(&y);
            arm || thumb || (y < 25 && (12..40).contains(&x))
        });
        let hidden = covered.hidden(&mask);
        let known = |x: u32, y: u32| !hidden.is_hand(x, y);
        assert!(known(20, 10), "the palm");
        assert!(!known(20, 40) && !known(27, 50), "the arm");
        assert!(!known(28, 50), "what is beside the arm");
        assert!(known(36, 40) && known(36, 44), "the thumb");
        assert!(known(41, 40) && known(36, 46), "what is beside the thumb");
        assert!(!known(45, 40), "what may be a sleeve");
    }
}
