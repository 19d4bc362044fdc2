//! How far an arm is known.

use glam::{DVec2, DVec3};
use phalanx_camera::Camera;

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
    /// Whether nothing is known of a pixel.
    pub(super) fn covers(&self, pixel: DVec2) -> bool {
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
