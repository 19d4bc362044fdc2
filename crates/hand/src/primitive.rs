//! The solids that draw a hand.

use glam::{DAffine3, DMat3, DVec3};

/// A sphere: centre and radius, both in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Centre, mm.
    pub center: DVec3,
    /// Radius, mm; positive.
    pub radius: f64,
}

impl Sphere {
    /// A sphere from its centre and radius, mm.
    pub const fn new(center: DVec3, radius: f64) -> Self {
        Self { center, radius }
    }
}

/// A convex solid of the hand. Each is the convex hull of spheres, or a squashed one, so that its
/// outline in any pinhole camera is the convex hull of ellipses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Primitive {
    /// One sphere.
    Sphere(Sphere),
    /// The convex hull of two spheres: a finger's phalanx.
    RoundCone([Sphere; 2]),
    /// The convex hull of three spheres: a piece of the palm or of the web between fingers.
    Wedge([Sphere; 3]),
    /// The convex hull of two spheres, squashed: a cylinder of elliptic section that may taper,
    /// such as the forearm.
    GeneralisedCylinder {
        /// The two ends before squashing, mm. Their line is not parallel to `thin_axis`.
        ends: [Sphere; 2],
        /// Unit vector along which the solid is squashed about `ends[0].center`.
        thin_axis: DVec3,
        /// Thickness along `thin_axis` over width across it, in (0, 1].
        flatness: f64,
    },
}

impl Primitive {
    /// The spheres whose hull the solid is (before squashing).
    pub fn spheres(&self) -> &[Sphere] {
        match self {
            Self::Sphere(sphere) => std::slice::from_ref(sphere),
            Self::RoundCone(spheres) => spheres,
            Self::Wedge(spheres) => spheres,
            Self::GeneralisedCylinder { ends, .. } => ends,
        }
    }

    /// The squash S (symmetric, 3×3) that maps the hull of [`spheres`](Self::spheres), taken
    /// relative to the first sphere's centre, to the solid; the identity for round solids.
    pub fn squash(&self) -> DMat3 {
        match self {
            Self::GeneralisedCylinder { thin_axis: n, flatness, .. } => {
                let outer = DMat3::from_cols(*n * n.x, *n * n.y, *n * n.z);
                DMat3::IDENTITY + outer * (*flatness - 1.0)
            }
            _ => DMat3::IDENTITY,
        }
    }

    /// The solid moved by a rigid motion (a rotation, possibly with a reflection, and a shift).
    ///
    /// ```
    /// use glam::{DAffine3, DVec3};
    /// use phalanx_hand::{Sphere, Primitive};
    ///
    /// let up = DAffine3::from_translation(DVec3::Y);
    /// let sphere = Primitive::Sphere(Sphere::new(DVec3::ZERO, 8.0));
    /// assert_eq!(sphere.moved(&up).spheres(), [Sphere::new(DVec3::Y, 8.0)]);
    /// ```
    #[must_use]
    pub fn moved(&self, motion: &DAffine3) -> Self {
        let sphere = |b: &Sphere| Sphere::new(motion.transform_point3(b.center), b.radius);
        match self {
            Self::Sphere(b) => Self::Sphere(sphere(b)),
            Self::RoundCone(spheres) => Self::RoundCone(spheres.each_ref().map(sphere)),
            Self::Wedge(spheres) => Self::Wedge(spheres.each_ref().map(sphere)),
            Self::GeneralisedCylinder { ends, thin_axis, flatness } => Self::GeneralisedCylinder {
                ends: ends.each_ref().map(sphere),
                thin_axis: motion.transform_vector3(*thin_axis),
                flatness: *flatness,
            },
        }
    }
}
