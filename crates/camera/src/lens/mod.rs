//! Lenses: where they put the directions that a pinhole would see.

mod distortion;
mod fisheye;
mod positive;

use glam::DVec2;
use serde::{Deserialize, Serialize};

pub use distortion::Distortion;
pub use fisheye::Fisheye;

/// A lens, as a map of the normalised image plane (z = 1) to itself.
///
/// ```
/// use glam::DVec2;
/// use phalanx_camera::{Distortion, Fisheye, Lens};
///
/// let barrel = Lens::from(Distortion { k1: -0.2, ..Distortion::NONE });
/// let wide = Lens::from(Fisheye::default());
/// let point = DVec2::new(1.0, 0.0); // 45° off the axis
/// assert_eq!(barrel.distort(point).x, 0.8);
/// assert_eq!(wide.distort(point).x, std::f64::consts::FRAC_PI_4);
/// assert_eq!(Lens::PERFECT.undistort(point), Some(point));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Lens {
    /// Straight lines stay straight but for OpenCV's distortion.
    Perspective(Distortion),
    /// The radius follows the angle, not its tangent.
    Fisheye(Fisheye),
}

impl Lens {
    /// A perfect lens.
    pub const PERFECT: Self = Self::Perspective(Distortion::NONE);

    /// Where folds are no longer looked for: a radius of the normalised plane, 89.9° off the axis.
    pub const FARTHEST: f64 = distortion::FARTHEST;

    /// Whether the lens is perfect.
    pub fn is_perfect(&self) -> bool {
        *self == Self::PERFECT
    }

    /// Where the lens puts a point of the normalised plane.
    pub fn distort(&self, point: DVec2) -> DVec2 {
        match self {
            Self::Perspective(distortion) => distortion.distort(point),
            Self::Fisheye(fisheye) => fisheye.distort(point),
        }
    }

    /// The point of the normalised plane that the lens puts at `distorted`; `None` where there is
    /// none short of the fold.
    pub fn undistort(&self, distorted: DVec2) -> Option<DVec2> {
        match self {
            Self::Perspective(distortion) => distortion.undistort(distorted),
            Self::Fisheye(fisheye) => fisheye.undistort(distorted),
        }
    }

    /// Whether the lens has not folded over at this point of the normalised plane: the radial part
    /// grows all the way from the middle of the picture to it.
    pub fn is_one_to_one_at(&self, point: DVec2) -> bool {
        match self {
            Self::Perspective(distortion) => distortion.is_one_to_one_at(point),
            Self::Fisheye(fisheye) => fisheye.is_one_to_one_at(point),
        }
    }

    /// The farthest point, up to `point` and in its direction, at which the lens has not folded
    /// over.
    ///
    /// ```
    /// use glam::DVec2;
    /// use phalanx_camera::{Distortion, Lens};
    ///
    /// let lens = Lens::from(Distortion { k1: -1.0 / 3.0, ..Distortion::NONE });
    /// assert!((lens.short_of_fold(DVec2::X * 5.0) - DVec2::X).length() < 1e-12);
    /// assert_eq!(lens.short_of_fold(DVec2::Y * 0.5), DVec2::Y * 0.5);
    /// ```
    pub fn short_of_fold(&self, point: DVec2) -> DVec2 {
        let end = point.clamp_length_max(Self::FARTHEST);
        if self.is_one_to_one_at(end) {
            return end;
        }
        let (mut short, mut beyond) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (short + beyond);
            if self.is_one_to_one_at(end * middle) {
                short = middle;
            } else {
                beyond = middle;
            }
        }
        end * short
    }

    /// The coefficients in OpenCV's order, as many as are needed: 5, 8, 12 or 14, or a fisheye's 4.
    pub fn coefficients(&self) -> Vec<f64> {
        match self {
            Self::Perspective(distortion) => distortion.coefficients(),
            Self::Fisheye(Fisheye { k1, k2, k3, k4 }) => vec![*k1, *k2, *k3, *k4],
        }
    }

    /// Whether every coefficient is a number that a lens can have.
    pub(crate) fn is_valid(&self) -> bool {
        let tilted = |distortion: &Distortion| {
            let most = std::f64::consts::FRAC_PI_2;
            distortion.tau_x.abs() < most && distortion.tau_y.abs() < most
        };
        self.coefficients().iter().all(|k| k.is_finite())
            && match self {
                Self::Perspective(distortion) => tilted(distortion),
                Self::Fisheye(_) => true,
            }
    }
}

impl Default for Lens {
    fn default() -> Self {
        Self::PERFECT
    }
}

impl From<Distortion> for Lens {
    fn from(distortion: Distortion) -> Self {
        Self::Perspective(distortion)
    }
}

impl From<Fisheye> for Lens {
    fn from(fisheye: Fisheye) -> Self {
        Self::Fisheye(fisheye)
    }
}
