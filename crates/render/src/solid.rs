//! Solids to cast rays at.

use std::ops::Range;

use glam::{DMat3, DVec2, DVec3};
use phalanx_hand::Primitive;

use crate::clip::{NEAR, plane_between};
use crate::surface::{Hit, Ray, Surface};

/// A rectangle of the image, px.
#[derive(Debug, Clone, Copy)]
struct Window {
    least: DVec2,
    most: DVec2,
}

/// A hull of spheres, squashed.
#[derive(Debug, Clone)]
struct Solid {
    /// Which surfaces are the hull's.
    surfaces: Range<usize>,
    window: Window,
    /// What undoes the squash, about the anchor.
    unsquash: DMat3,
    anchor: DVec3,
    /// It holds the camera's centre, and is before everything else.
    holds_camera: bool,
}

/// The solids of one picture, in the camera's frame.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scene {
    solids: Vec<Solid>,
    surfaces: Vec<Surface>,
}

impl Scene {
    pub(crate) fn clear(&mut self) {
        self.solids.clear();
        self.surfaces.clear();
    }

    /// Adds a solid and its outline in the picture.
    pub(crate) fn push(&mut self, solid: &Primitive, outline: &[DVec2]) {
        let start = self.surfaces.len();
        self.surfaces.extend(Surface::of(solid));
        // The outline's polygon may stay a little inside the outline.
        let margin = DVec2::splat(0.5);
        self.solids.push(Solid {
            surfaces: start..self.surfaces.len(),
            window: Window {
                least: outline.iter().copied().fold(DVec2::INFINITY, DVec2::min) - margin,
                most: outline.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max) + margin,
            },
            unsquash: solid.squash().inverse(),
            anchor: solid.spheres()[0].center,
            holds_camera: plane_between(solid).is_none(),
        });
    }

    /// Whether a solid may be seen at this pixel position.
    pub(crate) fn may_show_at(&self, pixel: DVec2) -> bool {
        self.solids.iter().any(|solid| solid.window.contains(pixel))
    }

    /// What a ray from the camera's centre meets first, given the pixel that it belongs to.
    pub(crate) fn nearest(&self, pixel: DVec2, direction: DVec3) -> Option<Hit> {
        let seen = self.solids.iter().filter(|solid| solid.window.contains(pixel));
        first(seen.filter_map(|solid| solid.enter(direction, &self.surfaces)))
    }
}

impl Window {
    fn contains(&self, pixel: DVec2) -> bool {
        pixel.cmpge(self.least).all() && pixel.cmple(self.most).all()
    }
}

impl Solid {
    fn enter(&self, direction: DVec3, surfaces: &[Surface]) -> Option<Hit> {
        if self.holds_camera {
            return Some(Hit { distance: NEAR, normal: -direction });
        }
        // A squash maps lines to lines and keeps ratios along them, so distances stay.
        let ray = Ray {
            origin: self.anchor - self.unsquash * self.anchor,
            direction: self.unsquash * direction,
        };
        let surfaces = &surfaces[self.surfaces.clone()];
        // The ray's line enters the solid either before the camera or behind it.
        let hit = first(surfaces.iter().filter_map(|surface| surface.enter(&ray)))
            .filter(|hit| hit.distance > 0.0)?;
        let normal = self.unsquash.transpose() * hit.normal;
        Some(Hit { distance: hit.distance.max(NEAR), normal })
    }
}

fn first(hits: impl Iterator<Item = Hit>) -> Option<Hit> {
    hits.min_by(|a, b| a.distance.total_cmp(&b.distance))
}

#[cfg(test)]
mod tests;
