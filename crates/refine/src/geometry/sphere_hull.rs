//! How far a camera's ray passes a hull of spheres.
//!
//! A ray begins at the camera: of a primitive that crosses the camera's plane it passes what is in front,
//! and what is behind it passes at the camera's centre.

use glam::{DMat3, DVec3};
use phalanx_hand::Primitive;

use crate::geometry::bound::Bound;

/// A primitive of the hand in a camera's frame, as rays from the camera's centre see it.
///
/// A ray touches the hull of some spheres where it touches one of the spheres whose centres and radii
/// are means of theirs, weighted alike: ρ = min over weights of |distance of the ray from the
/// centre| − radius is 0 on the outline, exactly and in any perspective. Where spheres are behind the
/// camera it is so only for edges, which is enough: nothing is seen there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SphereHull {
    centers: [DVec3; 3],
    radii: [f64; 3],
    spheres: usize,
    /// Normals of the planes through the camera's centre and two of the centres, opposite to each.
    planes: [DVec3; 3],
    /// From where the spheres are held to the primitive, if it is squashed.
    squash: Option<DMat3>,
    /// What undoes the squash of a squashed primitive; rays are taken through it before they are
    /// compared with the spheres.
    unsquash: Option<DMat3>,
}

/// Where a ray passes a hull most closely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ClosestApproach {
    /// ρ, mm: positive outside.
    pub(crate) distance: f64,
    /// Weights of the spheres, summing to 1.
    pub(crate) weights: [f64; 3],
    /// ∂ρ of a shift of the spheres, in the camera's frame; zero where the ray goes through the
    /// middle.
    pub(crate) normal: DVec3,
    /// For a squashed primitive the point of the ray that its rigid motion acts at, in the camera's
    /// frame.
    pub(crate) point: Option<DVec3>,
}

/// A ray, and how it passes the centres of spheres.
struct Sight<'a> {
    ray: DVec3,
    /// From the ray's beginning.
    centers: &'a [DVec3; 3],
    /// How far along the ray they are.
    depths: [f64; 3],
    /// From the ray's line.
    across: [DVec3; 3],
}

impl Sight<'_> {
    /// From the nearest place of the ray, for spheres whose depth has the sign of `depth`.
    fn to(&self, depth: f64) -> &[DVec3; 3] {
        if depth < 0.0 { self.centers } else { &self.across }
    }
}

/// What is as near as something else up to this, mm, is looked at as exactly as that: neighbouring phalanges share a
/// sphere.
const ALIKE: f64 = 1e-9;

/// Which sphere of a hull a ray passes most closely.
struct Nearest {
    distance: f64,
    weights: [f64; 3],
    /// The ray goes through the middle of the hull.
    through: bool,
}

impl SphereHull {
    /// Of a primitive in the camera's frame.
    pub(crate) fn new(primitive: &Primitive) -> Self {
        let spheres = primitive.spheres();
        let at = |k: usize| spheres[k.min(spheres.len() - 1)];
        let squash =
            matches!(primitive, Primitive::GeneralisedCylinder { .. }).then(|| primitive.squash());
        let unsquash = squash.map(|squash| squash.inverse());
        let shift = unsquash.map_or(DVec3::ZERO, |m| m * at(0).center - at(0).center);
        let centers = [0, 1, 2].map(|k| at(k).center + shift);
        Self {
            centers,
            radii: [0, 1, 2].map(|k| at(k).radius),
            spheres: spheres.len(),
            planes: [(1, 2), (2, 0), (0, 1)].map(|(i, j)| centers[i].cross(centers[j])),
            squash,
            unsquash,
        }
    }

    /// Its outline's whereabouts in the plane z = 1: anywhere, if it comes close to the camera's plane.
    pub(crate) fn bound(&self) -> Bound {
        // Undoing a squash only takes things apart: what passes the spheres where the solid has them
        // passes the solid no nearer than that.
        let centers = self.centers.map(|center| self.squash.map_or(center, |m| m * center));
        Bound::of(self.spheres, centers, self.radii)
    }

    /// Where the ray of unit direction `ray` from the camera's centre passes.
    pub(crate) fn closest_approach(&self, ray: DVec3) -> ClosestApproach {
        self.closest_approach_within(f64::INFINITY, ray).expect("any distance is within")
    }

    /// The same; nothing where that is no nearer than a distance, mm.
    pub(crate) fn closest_approach_within(
        &self,
        distance: f64,
        ray: DVec3,
    ) -> Option<ClosestApproach> {
        let Some(unsquash) = self.unsquash else {
            return self.closest_approach_to_spheres(distance, ray);
        };
        let stretched = unsquash * ray;
        let length = stretched.length();
        let approach = self.closest_approach_to_spheres(distance, stretched / length)?;
        let foot = self.center(&approach.weights).dot(stretched).max(0.0) / (length * length);
        Some(ClosestApproach {
            normal: unsquash * approach.normal,
            point: Some(ray * foot),
            ..approach
        })
    }

    fn closest_approach_to_spheres(&self, within: f64, ray: DVec3) -> Option<ClosestApproach> {
        let depths = self.centers.map(|center| center.dot(ray));
        let across = [0, 1, 2].map(|k| self.centers[k] - ray * depths[k]);
        let sight = Sight { ray, centers: &self.centers, depths, across };
        let nearest = |distance, weights| Nearest { distance, weights, through: false };
        let Nearest { distance, weights, through } = match self.spheres {
            1 => nearest(sight.to(depths[0])[0].length() - self.radii[0], [1.0, 0.0, 0.0]),
            2 => {
                let (distance, t) = self.edge(&sight, [0, 1], within)?;
                nearest(distance, [1.0 - t, t, 0.0])
            }
            _ => self.triangle(&sight, within)?,
        };
        if distance >= within {
            return None;
        }
        let depth = depths[0] * weights[0] + depths[1] * weights[1] + depths[2] * weights[2];
        let to = sight.to(depth);
        let offset = to[0] * weights[0] + to[1] * weights[1] + to[2] * weights[2];
        let normal = if through { DVec3::ZERO } else { offset.normalize_or_zero() };
        Some(ClosestApproach { distance, weights, normal, point: None })
    }

    /// ρ of the hull of two spheres and the second one's weight; nothing where it is surely no less than
    /// `within`.
    fn edge(&self, sight: &Sight<'_>, ends: [usize; 2], within: f64) -> Option<(f64, f64)> {
        let [first, last] = ends.map(|k| sight.depths[k]);
        if (first < 0.0) == (last < 0.0) {
            return self.part_of_edge(sight.to(first), ends, [0.0, 1.0], within);
        }
        let crossing = first / (first - last);
        let parts = [(first, [0.0, crossing]), (last, [crossing, 1.0])];
        let parts =
            parts.map(|(depth, span)| self.part_of_edge(sight.to(depth), ends, span, within));
        parts.into_iter().flatten().min_by(|one, other| one.0.total_cmp(&other.0))
    }

    /// The same of spheres whose weight is within a span, with where the ray passes them.
    fn part_of_edge(
        &self,
        offsets: &[DVec3; 3],
        [from, to]: [usize; 2],
        span: [f64; 2],
        within: f64,
    ) -> Option<(f64, f64)> {
        let (p, q) = (offsets[from], offsets[to] - offsets[from]);
        let (r, growth) = (self.radii[from], self.radii[to] - self.radii[from]);
        let squared = q.length_squared();
        let foot = -p.dot(q) / squared;
        // No sphere comes nearer than the largest one would on the nearest place of the axis.
        let reach = within + r.max(r + growth) + ALIKE;
        if reach <= 0.0 || (p + q * foot.clamp(span[0], span[1])).length_squared() >= reach * reach
        {
            return None;
        }
        let beyond = squared - growth * growth;
        let t = if beyond > 1e-12 * squared {
            let height = (p + q * foot).length();
            (foot + growth * height / (squared * beyond).sqrt()).clamp(span[0], span[1])
        } else if growth > 0.0 {
            // The larger sphere hides the smaller one.
            span[1]
        } else {
            span[0]
        };
        Some(((p + q * t).length() - r - growth * t, t))
    }

    /// ρ of the hull of three spheres: on an edge or, where the ray goes through the triangle of the
    /// centres, there; nothing where it is surely no less than `within`.
    fn triangle(&self, sight: &Sight<'_>, within: f64) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let within = best.as_ref().map_or(within, |best| best.distance.min(within));
            if let Some((distance, t)) = self.edge(sight, [from, to], within)
                && distance < within
            {
                let mut weights = [0.0; 3];
                weights[from] = 1.0 - t;
                weights[to] = t;
                best = Some(Nearest { distance, weights, through: false });
            }
        }
        let Sight { ray, depths, .. } = sight;
        let areas = self.planes.map(|plane| plane.dot(*ray));
        let whole = areas[0] + areas[1] + areas[2];
        let depth: f64 = areas.iter().zip(depths).map(|(area, depth)| area * depth).sum();
        if depth * whole >= 0.0 && areas.iter().all(|area| area * whole > 0.0) {
            // The middle is far inside; how far does not matter, but must not jump.
            let smallest = (0..3).min_by(|&i, &j| self.radii[i].total_cmp(&self.radii[j]));
            let smallest = smallest.unwrap_or(0);
            let distance = -self.radii[smallest];
            if best.as_ref().is_none_or(|best| distance < best.distance) {
                let mut weights = [0.0; 3];
                weights[smallest] = 1.0;
                return Some(Nearest { distance, weights, through: true });
            }
        }
        best
    }

    fn center(&self, weights: &[f64; 3]) -> DVec3 {
        self.centers[0] * weights[0] + self.centers[1] * weights[1] + self.centers[2] * weights[2]
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use phalanx_hand::Sphere;
    use proptest::prelude::*;

    use super::*;

    fn sphere() -> impl Strategy<Value = Sphere> {
        sphere_at(600.0)
    }

    /// Around a depth, mm.
    fn sphere_at(depth: f64) -> impl Strategy<Value = Sphere> {
        (prop::array::uniform3(-60.0..60.0_f64), 2.0..20.0_f64).prop_map(move |(at, radius)| {
            Sphere::new(DVec3::from_array(at) + DVec3::Z * depth, radius)
        })
    }

    /// ρ by trying many spheres of the hull.
    fn slow(spheres: &[Sphere; 3], ray: DVec3) -> f64 {
        const STEPS: i32 = 60;
        let mut least = f64::INFINITY;
        for i in 0..=STEPS {
            for j in 0..=STEPS - i {
                let (s, t) = (f64::from(i) / f64::from(STEPS), f64::from(j) / f64::from(STEPS));
                let weights = [1.0 - s - t, s, t];
                let center: DVec3 = spheres.iter().zip(weights).map(|(b, w)| b.center * w).sum();
                let radius: f64 = spheres.iter().zip(weights).map(|(b, w)| b.radius * w).sum();
                let foot = ray * center.dot(ray).max(0.0);
                least = least.min((center - foot).length() - radius);
            }
        }
        least
    }

    proptest! {
        #![proptest_config(crate::property::cases(128))]

        #[test]
        fn rays_pass_hulls_as_they_pass_the_nearest_of_their_spheres(
            spheres in prop::array::uniform3(sphere()),
            at in prop::array::uniform2(-0.15..0.15_f64),
        ) {
            let place = DVec2::from_array(at);
            let ray = place.extend(1.0).normalize();
            let hull = SphereHull::new(&Primitive::Wedge(spheres));
            let (fast, slow) = (hull.closest_approach(ray).distance, slow(&spheres, ray));
            // The slow one's spheres are a few millimetres apart. Through the middle it is enough to
            // be inside.
            let alike = fast <= slow + 1e-9 && slow - fast < 3.0;
            prop_assert!(alike || (fast < -1.9 && slow < fast), "{fast} is not {slow}");
            for beyond in [1e-6, 1.0, 10.0] {
                prop_assert!(!hull.bound().is_beyond(place, fast + beyond));
                let [nearer, further] =
                    [-beyond, beyond].map(|by| hull.closest_approach_within(fast + by, ray));
                prop_assert_eq!(nearer, None);
                prop_assert_eq!(further, Some(hull.closest_approach(ray)));
            }
        }

        /// A primitive that crosses the camera's plane.
        #[test]
        fn rays_begin_at_the_camera(
            ends in (sphere_at(60.0), sphere_at(-60.0)),
            at in prop::array::uniform2(-0.5..0.5_f64),
        ) {
            let place = DVec2::from_array(at);
            let ray = place.extend(1.0).normalize();
            let hull = SphereHull::new(&Primitive::RoundCone(ends.into()));
            let approach = hull.closest_approach(ray);
            let slow = slow(&[ends.0, ends.1, ends.1], ray);
            prop_assert!(approach.distance <= slow + 1e-9, "{approach:?} is not {slow}");
            prop_assert!(slow - approach.distance < 3.0, "{approach:?} is not {slow}");
            prop_assert!(!hull.bound().is_beyond(place, 1e3));
            // The normal is the distance's slope.
            let moved = |by: DVec3| {
                let ends = [ends.0, ends.1].map(|sphere| Sphere::new(sphere.center + by, sphere.radius));
                SphereHull::new(&Primitive::RoundCone(ends)).closest_approach(ray).distance
            };
            let slope = |axis: DVec3| (moved(axis * 1e-5) - moved(axis * -1e-5)) / 2e-5;
            let slopes = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
            prop_assume!(approach.distance > -1.0);
            prop_assert!(slopes.distance(approach.normal) < 1e-3, "{slopes} is not {approach:?}");
        }

        #[test]
        fn no_ray_passes_a_squashed_solid_nearer_than_its_bound(
            ends in prop::array::uniform2(sphere()),
            thin in prop::array::uniform3(-1.0..1.0_f64),
            flatness in 0.3..1.0_f64,
            at in prop::array::uniform2(-0.2..0.2_f64),
        ) {
            let thin_axis = DVec3::from_array(thin).try_normalize().unwrap_or(DVec3::X);
            let hull = SphereHull::new(&Primitive::GeneralisedCylinder { ends, thin_axis, flatness });
            let place = DVec2::from_array(at);
            let approach = hull.closest_approach(place.extend(1.0).normalize()).distance;
            for beyond in [1e-6, 1.0, 10.0] {
                prop_assert!(!hull.bound().is_beyond(place, approach + beyond));
            }
        }
    }
}
