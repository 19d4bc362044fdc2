//! The solids that draw a hand.

use glam::{DAffine3, DMat3, DVec3};

/// A ball: centre and radius, both in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// Centre, mm.
    pub center: DVec3,
    /// Radius, mm; positive.
    pub radius: f64,
}

impl Ball {
    /// A ball from its centre and radius, mm.
    pub const fn new(center: DVec3, radius: f64) -> Self {
        Self { center, radius }
    }
}

/// A convex solid of the hand. Each is the convex hull of balls, or a squashed one, so that its
/// outline in any pinhole camera is the convex hull of ellipses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Primitive {
    /// One ball.
    Sphere(Ball),
    /// The convex hull of two balls: a finger's phalanx.
    RoundCone([Ball; 2]),
    /// The convex hull of three balls: a piece of the palm or of the web between fingers.
    Wedge([Ball; 3]),
    /// The convex hull of two balls, squashed: a cylinder of elliptic section that may taper,
    /// such as the forearm.
    GeneralisedCylinder {
        /// The two ends before squashing, mm. Their line is not parallel to `thin_axis`.
        ends: [Ball; 2],
        /// Unit vector along which the solid is squashed about `ends[0].center`.
        thin_axis: DVec3,
        /// Thickness along `thin_axis` over width across it, in (0, 1].
        flatness: f64,
    },
}

impl Primitive {
    /// The balls whose hull the solid is (before squashing).
    pub fn balls(&self) -> &[Ball] {
        match self {
            Self::Sphere(ball) => std::slice::from_ref(ball),
            Self::RoundCone(balls) => balls,
            Self::Wedge(balls) => balls,
            Self::GeneralisedCylinder { ends, .. } => ends,
        }
    }

    /// The squash S (symmetric, 3×3) that maps the hull of [`balls`](Self::balls), taken
    /// relative to the first ball's centre, to the solid; the identity for round solids.
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
    /// use phalanx_hand::{Ball, Primitive};
    ///
    /// let up = DAffine3::from_translation(DVec3::Y);
    /// let ball = Primitive::Sphere(Ball::new(DVec3::ZERO, 8.0));
    /// assert_eq!(ball.moved(&up).balls(), [Ball::new(DVec3::Y, 8.0)]);
    /// ```
    #[must_use]
    pub fn moved(&self, motion: &DAffine3) -> Self {
        let ball = |b: &Ball| Ball::new(motion.transform_point3(b.center), b.radius);
        match self {
            Self::Sphere(b) => Self::Sphere(ball(b)),
            Self::RoundCone(balls) => Self::RoundCone(balls.each_ref().map(ball)),
            Self::Wedge(balls) => Self::Wedge(balls.each_ref().map(ball)),
            Self::GeneralisedCylinder { ends, thin_axis, flatness } => Self::GeneralisedCylinder {
                ends: ends.each_ref().map(ball),
                thin_axis: motion.transform_vector3(*thin_axis),
                flatness: *flatness,
            },
        }
    }
}
