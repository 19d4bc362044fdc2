//! Where outlines may be: what a ray surely passes need not be looked at more closely.

use glam::{DVec2, DVec3};

/// A point, line or triangle of the plane z = 1 and how far the outline may be from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bound {
    corners: usize,
    seen: [DVec2; 3],
    /// A disc that holds the corners.
    middle: DVec2,
    around: f64,
    reach: f64,
    /// How far apart, in the plane, at most what passes by a millimetre is.
    per_mm: f64,
}

impl Bound {
    /// Of the hull of the first `spheres` of some spheres in the camera's frame, of which the others are equal to one of
    /// these: anywhere, if it comes close to the camera's plane.
    pub(crate) fn of(spheres: usize, centers: [DVec3; 3], radii: [f64; 3]) -> Self {
        // A sphere off the axis is seen wider by less than this, if its depth is some radii.
        const WIDER: f64 = 1.1;
        const RADII: f64 = 4.0;
        // A ray off the axis passes nearer than the plane says, by no more than this.
        const NEARER: f64 = 0.8;
        let seen = centers.map(|center| center.truncate() / center.z);
        let reach = [0, 1, 2].map(|k| WIDER * radii[k] / centers[k].z);
        let depth = centers[0].z.min(centers[1].z).min(centers[2].z);
        let middle = (seen[0] + seen[1] + seen[2]) / 3.0;
        let around = seen.map(|corner| corner.distance(middle));
        let is_close = (0..3).any(|k| centers[k].z < RADII * radii[k]);
        Self {
            corners: spheres,
            seen,
            middle,
            around: around[0].max(around[1]).max(around[2]),
            reach: if is_close { f64::INFINITY } else { reach[0].max(reach[1]).max(reach[2]) },
            per_mm: 1.0 / (NEARER * depth),
        }
    }

    /// Whether the ray through a place of the plane z = 1 surely passes at least so far off, mm.
    #[inline]
    pub(crate) fn is_beyond(&self, place: DVec2, distance: f64) -> bool {
        let apart = self.reach + distance.max(0.0) * self.per_mm;
        let of_disc = apart + self.around;
        place.distance_squared(self.middle) >= of_disc * of_disc
            || self.is_off_corners(place, apart * apart)
    }

    /// Whether a place is at least so far, squared, from the point, line or triangle.
    fn is_off_corners(&self, place: DVec2, squared: f64) -> bool {
        let [a, b, c] = self.seen;
        match self.corners {
            1 => place.distance_squared(a) >= squared,
            2 => squared_distance(place, a, b) >= squared,
            _ => {
                let side = |from: DVec2, to: DVec2| (to - from).perp_dot(place - from) > 0.0;
                let sides = [side(a, b), side(b, c), side(c, a)];
                let within = sides[0] == sides[1] && sides[1] == sides[2];
                !within
                    && [(a, b), (b, c), (c, a)]
                        .iter()
                        .all(|&(a, b)| squared_distance(place, a, b) >= squared)
            }
        }
    }
}

/// The squared distance of a point from a line between two others.
fn squared_distance(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let (line, offset) = (to - from, point - from);
    let along = (offset.dot(line) / line.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    offset.distance_squared(line * along)
}
