//! Where a ray enters a hull of spheres, in closed form.
//!
//! The hull of up to three spheres is bounded by pieces of the spheres, of the cones that touch two
//! of them and of the planes that touch all three. All of these surfaces lie within the hull,
//! so the first that a ray from outside enters is where it enters the hull. There are no cracks:
//! spheres and cones go on underneath what they touch.

use glam::{DMat2, DVec2, DVec3};
use phalanx_hand::{Primitive, Sphere};

/// A ray; distances along it are in units of its direction's length.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

/// Where a ray enters a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// How far along the ray.
    pub(crate) distance: f64,
    /// Outward normal, of any length.
    pub(crate) normal: DVec3,
}

#[derive(Debug, Clone)]
pub(crate) enum Surface {
    Sphere(Sphere),
    Cone(Cone),
    Face(Face),
}

impl Surface {
    /// All surfaces of the hull of a solid's spheres, as they are before it is squashed.
    pub(crate) fn of(solid: &Primitive) -> impl Iterator<Item = Self> {
        let spheres = solid.spheres();
        let round = spheres.iter().copied().map(Self::Sphere);
        let pairs = spheres.iter().enumerate().flat_map(|(index, a)| {
            spheres[index + 1..].iter().filter_map(move |b| Cone::between(a, b))
        });
        let faces = match solid {
            Primitive::Wedge(spheres) => Face::of(spheres),
            _ => None,
        };
        let faces = faces.into_iter().flatten().map(Self::Face);
        round.chain(pairs.map(Self::Cone)).chain(faces)
    }

    /// The outward unit normal of the plane that touches the surface and faces a point best.
    pub(crate) fn facing(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Sphere(sphere) => (point - sphere.center).normalize_or(DVec3::Z),
            Self::Cone(cone) => cone.facing(point),
            Self::Face(face) => face.normal,
        }
    }

    pub(crate) fn enter(&self, ray: &Ray) -> Option<Hit> {
        match self {
            Self::Sphere(sphere) => enter_sphere(sphere, ray),
            Self::Cone(cone) => cone.enter(ray),
            Self::Face(face) => face.enter(ray),
        }
    }
}

fn enter_sphere(sphere: &Sphere, ray: &Ray) -> Option<Hit> {
    let from_center = ray.origin - sphere.center;
    let distance = entering_root(
        ray.direction.length_squared(),
        ray.direction.dot(from_center),
        from_center.length_squared() - sphere.radius * sphere.radius,
    )?;
    Some(Hit { distance, normal: from_center + ray.direction * distance })
}

/// The surface that touches two spheres around: a cone between its circles of contact.
#[derive(Debug, Clone)]
pub(crate) struct Cone {
    center: DVec3,
    /// Unit vector towards the second sphere.
    axis: DVec3,
    radius: f64,
    /// The component of every normal along the axis.
    slope: f64,
    /// Where the circles of contact are along the axis.
    start: f64,
    end: f64,
}

impl Cone {
    /// `None` where one sphere holds the other.
    pub(crate) fn between(a: &Sphere, b: &Sphere) -> Option<Self> {
        let apart = b.center - a.center;
        let length = apart.length();
        if length <= (a.radius - b.radius).abs() {
            return None;
        }
        let slope = (a.radius - b.radius) / length;
        Some(Self {
            center: a.center,
            axis: apart / length,
            radius: a.radius,
            slope,
            start: a.radius * slope,
            end: length + b.radius * slope,
        })
    }

    fn facing(&self, point: DVec3) -> DVec3 {
        let out = (point - self.center).reject_from_normalized(self.axis);
        let out = out.normalize_or(self.axis.any_orthonormal_vector());
        out * (1.0 - self.slope * self.slope).sqrt() + self.axis * self.slope
    }

    /// A surface point at height z along the axis and ρ from it has z·slope + ρ·√(1 − slope²) =
    /// radius; squared, that is |q|² (1 − slope²) − z² + 2 radius slope z − radius² = 0.
    fn enter(&self, ray: &Ray) -> Option<Hit> {
        let (v, w) = (ray.direction, ray.origin - self.center);
        let (va, wa) = (v.dot(self.axis), w.dot(self.axis));
        let shrink = 1.0 - self.slope * self.slope;
        let lean = self.radius * self.slope;
        let distance = entering_root(
            shrink * v.length_squared() - va * va,
            shrink * v.dot(w) - va * wa + lean * va,
            shrink * w.length_squared() - wa * wa + 2.0 * lean * wa - self.radius * self.radius,
        )?;
        let height = wa + distance * va;
        if !(self.start..=self.end).contains(&height) {
            return None;
        }
        let out = w + v * distance - self.axis * height;
        let normal = out.normalize_or_zero() * shrink.sqrt() + self.axis * self.slope;
        Some(Hit { distance, normal })
    }
}

/// A triangle on a plane that touches three spheres.
#[derive(Debug, Clone)]
pub(crate) struct Face {
    corner: DVec3,
    edges: [DVec3; 2],
    /// Unit vector.
    normal: DVec3,
}

impl Face {
    /// The two faces of three spheres; `None` where no plane touches all three from one side:
    /// one sphere lies in the hull of the others, or all are in line.
    pub(crate) fn of([a, b, c]: &[Sphere; 3]) -> Option<[Self; 2]> {
        let (ab, ac) = (b.center - a.center, c.center - a.center);
        let across = ab.cross(ac);
        // A unit normal n has n·ab = ra − rb and n·ac = ra − rc; its part in the plane of the
        // centres is x ab + y ac.
        let gram = DMat2::from_cols_array(&[ab.dot(ab), ab.dot(ac), ab.dot(ac), ac.dot(ac)]);
        if across.length_squared() <= 1e-18 * gram.x_axis.x * gram.y_axis.y {
            return None;
        }
        let shrinking = DVec2::new(a.radius - b.radius, a.radius - c.radius);
        let weights = gram.inverse() * shrinking;
        let in_plane = ab * weights.x + ac * weights.y;
        let out_of_plane = 1.0 - in_plane.length_squared();
        if out_of_plane <= 0.0 {
            return None;
        }
        let lift = across.normalize() * out_of_plane.sqrt();
        Some([lift, -lift].map(|lift| {
            let normal = in_plane + lift;
            Self {
                corner: a.center + normal * a.radius,
                edges: [ab - normal * shrinking.x, ac - normal * shrinking.y],
                normal,
            }
        }))
    }

    fn enter(&self, ray: &Ray) -> Option<Hit> {
        let towards = self.normal.dot(ray.direction);
        if towards >= 0.0 {
            return None;
        }
        let distance = self.normal.dot(self.corner - ray.origin) / towards;
        let q = ray.origin + ray.direction * distance - self.corner;
        let [e, f] = self.edges;
        let (ee, ef, ff) = (e.dot(e), e.dot(f), f.dot(f));
        let area = ee * ff - ef * ef;
        let x = (ff * q.dot(e) - ef * q.dot(f)) / area;
        let y = (ee * q.dot(f) - ef * q.dot(e)) / area;
        (x >= 0.0 && y >= 0.0 && x + y <= 1.0).then_some(Hit { distance, normal: self.normal })
    }
}

/// The root of a t² + 2 b t + c where it falls through zero, that is, where a ray enters.
fn entering_root(a: f64, b: f64, c: f64) -> Option<f64> {
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    // Two forms of one root: the one without cancellation.
    let t = if b < 0.0 { c / (root - b) } else { -(b + root) / a };
    t.is_finite().then_some(t)
}
