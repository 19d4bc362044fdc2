//! How far a camera's ray passes a hull of balls.

use glam::{DMat3, DVec2, DVec3};
use phalanx_hand::Primitive;

/// A solid of the hand in a camera's frame, as rays from the camera's centre see it.
///
/// A ray touches the hull of some balls where it touches one of the balls whose centres and radii
/// are means of theirs, weighted alike: ρ = min over weights of |distance of the ray from the
/// centre| − radius is 0 on the outline, exactly and in any perspective.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hull {
    centers: [DVec3; 3],
    radii: [f64; 3],
    balls: usize,
    /// What undoes the squash of a squashed solid; rays are taken through it before they are
    /// compared with the balls.
    unsquash: Option<DMat3>,
}

/// Where a ray passes a hull most closely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Passing {
    /// ρ, mm: positive outside.
    pub(crate) distance: f64,
    /// Weights of the balls, summing to 1.
    pub(crate) weights: [f64; 3],
    /// ∂ρ of a shift of the balls, in the camera's frame; zero where the ray goes through the
    /// middle.
    pub(crate) normal: DVec3,
    /// For a squashed solid the point of the ray that its rigid motion acts at, in the camera's
    /// frame.
    pub(crate) point: Option<DVec3>,
}

/// A point, line or triangle of the plane z = 1 and how far the outline may be from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bound {
    corners: usize,
    seen: [DVec2; 3],
    reach: f64,
    depth: f64,
}

impl Bound {
    /// No more than the distance ρ, mm, of the ray through a place of the plane z = 1.
    pub(crate) fn least(&self, place: DVec2) -> f64 {
        // A ray off the axis passes nearer than the plane says.
        const OBLIQUE: f64 = 0.8;
        let [a, b, c] = self.seen;
        let apart = match self.corners {
            0 => return f64::NEG_INFINITY,
            1 => place.distance_squared(a),
            2 => squared_distance(place, a, b),
            _ => {
                let side = |from: DVec2, to: DVec2| (to - from).perp_dot(place - from) > 0.0;
                let sides = [side(a, b), side(b, c), side(c, a)];
                if sides[0] == sides[1] && sides[1] == sides[2] {
                    return f64::NEG_INFINITY;
                }
                let edges = [(a, b), (b, c), (c, a)].map(|(a, b)| squared_distance(place, a, b));
                edges[0].min(edges[1]).min(edges[2])
            }
        };
        OBLIQUE * (apart.sqrt() - self.reach) * self.depth
    }
}

/// The squared distance of a point from a line between two others.
fn squared_distance(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let (line, offset) = (to - from, point - from);
    let along = (offset.dot(line) / line.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    offset.distance_squared(line * along)
}

impl Hull {
    /// Of a solid in the camera's frame.
    pub(crate) fn new(solid: &Primitive) -> Self {
        let balls = solid.balls();
        let at = |k: usize| balls[k.min(balls.len() - 1)];
        let unsquash = matches!(solid, Primitive::GeneralisedCylinder { .. })
            .then(|| solid.squash().inverse());
        let shift = unsquash.map_or(DVec3::ZERO, |m| m * at(0).center - at(0).center);
        Self {
            centers: [0, 1, 2].map(|k| at(k).center + shift),
            radii: [0, 1, 2].map(|k| at(k).radius),
            balls: balls.len(),
            unsquash,
        }
    }

    /// Its outline's whereabouts in the plane z = 1.
    pub(crate) fn bound(&self) -> Bound {
        // A ball off the axis is seen wider by less than this.
        const OBLIQUE: f64 = 1.1;
        let seen = self.centers.map(|center| center.truncate() / center.z);
        let reach = [0, 1, 2].map(|k| OBLIQUE * self.radii[k] / self.centers[k].z);
        Bound {
            // Undoing the squash moves outlines: such a solid, the forearm, may be anywhere.
            corners: if self.unsquash.is_some() { 0 } else { self.balls },
            seen,
            reach: reach[0].max(reach[1]).max(reach[2]),
            depth: self.centers[0].z.min(self.centers[1].z).min(self.centers[2].z),
        }
    }

    /// Where the ray of unit direction `ray` from the camera's centre passes.
    pub(crate) fn pass(&self, ray: DVec3) -> Passing {
        let Some(unsquash) = self.unsquash else { return self.pass_round(ray) };
        let stretched = unsquash * ray;
        let length = stretched.length();
        let passing = self.pass_round(stretched / length);
        let foot = self.center(&passing.weights).dot(stretched) / (length * length);
        Passing { normal: unsquash * passing.normal, point: Some(ray * foot), ..passing }
    }

    fn pass_round(&self, ray: DVec3) -> Passing {
        let across = self.centers.map(|center| center - ray * center.dot(ray));
        let (distance, weights) = match self.balls {
            1 => (across[0].length() - self.radii[0], [1.0, 0.0, 0.0]),
            2 => {
                let (distance, t) = self.edge(&across, 0, 1);
                (distance, [1.0 - t, t, 0.0])
            }
            _ => self.triangle(&across, ray),
        };
        let offset = across[0] * weights[0] + across[1] * weights[1] + across[2] * weights[2];
        Passing { distance, weights, normal: offset.normalize_or_zero(), point: None }
    }

    /// ρ of the hull of two balls and the second one's weight.
    fn edge(&self, across: &[DVec3; 3], from: usize, to: usize) -> (f64, f64) {
        let (p, q) = (across[from], across[to] - across[from]);
        let (r, growth) = (self.radii[from], self.radii[to] - self.radii[from]);
        let squared = q.length_squared();
        let beyond = squared - growth * growth;
        let t = if beyond > 1e-12 * squared {
            let foot = -p.dot(q) / squared;
            let height = (p + q * foot).length();
            (foot + growth * height / (squared * beyond).sqrt()).clamp(0.0, 1.0)
        } else if growth > 0.0 {
            // The larger ball hides the smaller one.
            1.0
        } else {
            0.0
        };
        ((p + q * t).length() - r - growth * t, t)
    }

    /// ρ of the hull of three balls: on an edge or, where the ray goes through the triangle of the
    /// centres, there.
    fn triangle(&self, across: &[DVec3; 3], ray: DVec3) -> (f64, [f64; 3]) {
        let mut best = (f64::INFINITY, [1.0, 0.0, 0.0]);
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let (distance, t) = self.edge(across, from, to);
            if distance < best.0 {
                let mut weights = [0.0; 3];
                weights[from] = 1.0 - t;
                weights[to] = t;
                best = (distance, weights);
            }
        }
        let areas = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| across[i].cross(across[j]).dot(ray));
        let whole = areas[0] + areas[1] + areas[2];
        let weights = areas.map(|area| area / whole);
        if weights.iter().all(|&weight| weight > 0.0) {
            let radius: f64 = weights.iter().zip(self.radii).map(|(w, r)| w * r).sum();
            if -radius < best.0 {
                best = (-radius, weights);
            }
        }
        best
    }

    fn center(&self, weights: &[f64; 3]) -> DVec3 {
        self.centers[0] * weights[0] + self.centers[1] * weights[1] + self.centers[2] * weights[2]
    }
}
