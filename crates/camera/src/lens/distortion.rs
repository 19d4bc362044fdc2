//! OpenCV's distortion of a perspective lens and its inverse.

use glam::{DMat2, DMat3, DVec2};
use serde::{Deserialize, Serialize};

use crate::lens::positive::is_positive;

/// Where folds are no longer looked for: a radius of the normalised plane, 89.9° off the axis.
pub(crate) const FARTHEST: f64 = 1e3;

/// Radial and tangential distortion of the normalised image plane (z = 1), as in OpenCV's
/// `projectPoints` with up to 14 coefficients (D. C. Brown, 1966; the rational factor: D. Claus,
/// A. Fitzgibbon, 2005; the tilt is Scheimpflug's). With s = r² = x² + y²,
///
/// x′ = x q + 2 p1 x y + p2 (r² + 2x²) + s1 r² + s2 r⁴,
/// y′ = y q + p1 (r² + 2y²) + 2 p2 x y + s3 r² + s4 r⁴,
/// q = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶),
///
/// and then the sensor's tilt by `tau_x` and `tau_y`.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Distortion {
    /// Radial, second order.
    pub k1: f64,
    /// Radial, fourth order.
    pub k2: f64,
    /// Tangential.
    pub p1: f64,
    /// Tangential.
    pub p2: f64,
    /// Radial, sixth order.
    pub k3: f64,
    /// Radial, below the line, second order.
    pub k4: f64,
    /// Radial, below the line, fourth order.
    pub k5: f64,
    /// Radial, below the line, sixth order.
    pub k6: f64,
    /// Thin prism, along x, second order.
    pub s1: f64,
    /// Thin prism, along x, fourth order.
    pub s2: f64,
    /// Thin prism, along y, second order.
    pub s3: f64,
    /// Thin prism, along y, fourth order.
    pub s4: f64,
    /// The sensor's tilt about x, radians.
    pub tau_x: f64,
    /// The sensor's tilt about y, radians.
    pub tau_y: f64,
}

impl Distortion {
    /// A perfect lens.
    pub const NONE: Self = Self {
        k1: 0.0,
        k2: 0.0,
        p1: 0.0,
        p2: 0.0,
        k3: 0.0,
        k4: 0.0,
        k5: 0.0,
        k6: 0.0,
        s1: 0.0,
        s2: 0.0,
        s3: 0.0,
        s4: 0.0,
        tau_x: 0.0,
        tau_y: 0.0,
    };

    /// Accuracy of [`undistort`](Self::undistort), relative to the plane's unit.
    const TOLERANCE: f64 = 1e-12;

    /// From coefficients in OpenCV's order, k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y: none,
    /// or the first 4, 5, 8, 12 or all 14. `None` for any other number of them.
    ///
    /// ```
    /// use phalanx_camera::Distortion;
    ///
    /// let lens = Distortion::from_coefficients(&[-0.1, 0.02, 0.0, 0.0, 0.0]).expect("five");
    /// assert_eq!(lens, Distortion { k1: -0.1, k2: 0.02, ..Distortion::NONE });
    /// assert_eq!(Distortion::from_coefficients(&[-0.1, 0.02, 0.0]), None);
    /// ```
    pub fn from_coefficients(coefficients: &[f64]) -> Option<Self> {
        if !matches!(coefficients.len(), 0 | 4 | 5 | 8 | 12 | 14) {
            return None;
        }
        let mut all = [0.0; 14];
        all[..coefficients.len()].copy_from_slice(coefficients);
        let [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y] = all;
        Some(Self { k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y })
    }

    /// The coefficients in OpenCV's order: the first 5, 8, 12 or all 14, without a tail of zeros.
    pub fn coefficients(&self) -> Vec<f64> {
        let Self { k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y } = *self;
        let all = [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y];
        let count = [5, 8, 12].into_iter().find(|&n| all[n..].iter().all(|&k| k == 0.0));
        all[..count.unwrap_or(14)].to_vec()
    }

    /// Whether the lens is perfect.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Where the lens puts a point of the normalised plane.
    pub fn distort(&self, point: DVec2) -> DVec2 {
        let bent = self.bend(point);
        if self.is_tilted() { tilted(&self.tilt(), bent) } else { bent }
    }

    /// The point of the normalised plane that the lens puts at `distorted`, by damped Newton
    /// steps from the middle of the picture; `None` where there is none short of the fold.
    ///
    /// ```
    /// use glam::DVec2;
    /// use phalanx_camera::Distortion;
    ///
    /// let lens = Distortion { k1: -0.2, k2: 0.05, ..Distortion::NONE };
    /// let point = DVec2::new(0.3, -0.2);
    /// let bent = lens.distort(point);
    /// assert!(bent.length() < point.length()); // a barrel
    /// assert!((lens.undistort(bent).expect("short of the fold") - point).length() < 1e-11);
    /// ```
    pub fn undistort(&self, distorted: DVec2) -> Option<DVec2> {
        if self.is_none() {
            return distorted.is_finite().then_some(distorted);
        }
        // Near the fold a step from the middle may leap to the fold and stay there; the other start
        // is close to the point, but takes longer to find.
        self.descend(DVec2::ZERO, distorted)
            .or_else(|| self.descend(self.undistort_radially(distorted), distorted))
    }

    /// The point that the lens puts at `distorted`, by damped Newton steps from `point`.
    fn descend(&self, mut point: DVec2, distorted: DVec2) -> Option<DVec2> {
        let tolerance = Self::TOLERANCE * (1.0 + distorted.length());
        let mut error = self.distort(point) - distorted;
        for _ in 0..60 {
            if error.length() <= tolerance {
                return Some(point);
            }
            let step = self.jacobian(point).inverse() * error;
            (point, error) = (0..40).find_map(|halvings| {
                let next = point - step * 0.5f64.powi(halvings);
                let next_error = self.distort(next) - distorted;
                let better = next_error.length() < error.length();
                (better && self.is_one_to_one_at(next)).then_some((next, next_error))
            })?;
        }
        None
    }

    /// The point short of the fold that the radial part and the tilt put at `distorted`, or else
    /// the fold, by bisection.
    fn undistort_radially(&self, distorted: DVec2) -> DVec2 {
        let bent =
            if self.is_tilted() { tilted(&self.tilt().inverse(), distorted) } else { distorted };
        let (direction, radius) = (bent.normalize_or_zero(), bent.length());
        let (mut short, mut beyond) = (0.0, FARTHEST);
        for _ in 0..60 {
            let middle: f64 = 0.5 * (short + beyond);
            let s = middle * middle;
            let is_short = middle * self.above(s) / self.below(s) < radius;
            if is_short && self.is_one_to_one_at(direction * middle) {
                short = middle;
            } else {
                beyond = middle;
            }
        }
        direction * short
    }

    /// Whether the lens has not folded over at this point of the normalised plane: the radial
    /// part grows all the way from the middle of the picture to it, and it is before the tilted
    /// sensor's horizon.
    ///
    /// ```
    /// use glam::DVec2;
    /// use phalanx_camera::Distortion;
    ///
    /// let lens = Distortion { k1: -0.2, ..Distortion::NONE }; // r (1 − 0.2 r²) turns back at r = 1.29
    /// assert!(lens.is_one_to_one_at(DVec2::new(1.2, 0.0)));
    /// assert!(!lens.is_one_to_one_at(DVec2::new(1.4, 0.0)));
    /// ```
    pub fn is_one_to_one_at(&self, point: DVec2) -> bool {
        let s = point.length_squared();
        let grows = if self.is_rational() {
            let below = [1.0, self.k4, self.k5, self.k6];
            is_positive(below, s) && is_positive(self.rational_slope(), s)
        } else {
            is_positive([1.0, 3.0 * self.k1, 5.0 * self.k2, 7.0 * self.k3], s)
        };
        grows && (!self.is_tilted() || (self.tilt() * self.bend(point).extend(1.0)).z > 0.0)
    }

    fn is_rational(&self) -> bool {
        (self.k4, self.k5, self.k6) != (0.0, 0.0, 0.0)
    }

    fn is_tilted(&self) -> bool {
        (self.tau_x, self.tau_y) != (0.0, 0.0)
    }

    /// The distortion but for the tilt.
    fn bend(&self, point: DVec2) -> DVec2 {
        let (x, y) = (point.x, point.y);
        let s = point.length_squared();
        let tangential = DVec2::new(
            2.0 * self.p1 * x * y + self.p2 * (s + 2.0 * x * x),
            self.p1 * (s + 2.0 * y * y) + 2.0 * self.p2 * x * y,
        );
        let prism = DVec2::new(s * (self.s1 + s * self.s2), s * (self.s3 + s * self.s4));
        point * (self.above(s) / self.below(s)) + tangential + prism
    }

    /// The radial factor's numerator at squared radius `s`.
    fn above(&self, s: f64) -> f64 {
        1.0 + s * (self.k1 + s * (self.k2 + s * self.k3))
    }

    /// The radial factor's denominator at squared radius `s`.
    fn below(&self, s: f64) -> f64 {
        1.0 + s * (self.k4 + s * (self.k5 + s * self.k6))
    }

    /// The numerator of d/dr of r N(s) / D(s), s = r²: (N + 2 s N′) D − 2 s N D′, lowest coefficient
    /// first.
    fn rational_slope(&self) -> [f64; 7] {
        let above = [1.0, self.k1, self.k2, self.k3];
        let below = [1.0, self.k4, self.k5, self.k6];
        let mut slope = [0.0; 7];
        for (i, n) in above.iter().enumerate() {
            for (j, d) in below.iter().enumerate() {
                slope[i + j] += (1.0 + 2.0 * (i as f64 - j as f64)) * n * d;
            }
        }
        slope
    }

    /// The derivative of [`distort`](Self::distort).
    fn jacobian(&self, point: DVec2) -> DMat2 {
        let (x, y) = (point.x, point.y);
        let s = point.length_squared();
        let (above, below) = (self.above(s), self.below(s));
        let radial = above / below;
        // The radial factor's gradient is `growth` times the point.
        let above_slope = self.k1 + s * (2.0 * self.k2 + s * 3.0 * self.k3);
        let below_slope = self.k4 + s * (2.0 * self.k5 + s * 3.0 * self.k6);
        let growth = 2.0 * (above_slope - radial * below_slope) / below;
        let cross = growth * x * y + 2.0 * (self.p1 * x + self.p2 * y);
        let xx = radial + growth * x * x + 2.0 * self.p1 * y + 6.0 * self.p2 * x;
        let yy = radial + growth * y * y + 6.0 * self.p1 * y + 2.0 * self.p2 * x;
        let prism = 2.0 * DVec2::new(self.s1 + 2.0 * s * self.s2, self.s3 + 2.0 * s * self.s4);
        let bend =
            DMat2::from_cols(DVec2::new(xx, cross) + prism * x, DVec2::new(cross, yy) + prism * y);
        if self.is_tilted() { tilted_slope(&self.tilt(), self.bend(point)) * bend } else { bend }
    }

    /// The homography of the tilted sensor, OpenCV's `computeTiltProjectionMatrix`.
    fn tilt(&self) -> DMat3 {
        let turn = DMat3::from_rotation_y(-self.tau_y) * DMat3::from_rotation_x(-self.tau_x);
        // Element (row, column) of the turn.
        let [r02, r12, r22] = turn.z_axis.to_array();
        let onto_sensor =
            DMat3::from_cols_array_2d(&[[r22, 0.0, 0.0], [0.0, r22, 0.0], [-r02, -r12, 1.0]]);
        onto_sensor * turn
    }
}

/// A point by a homography.
fn tilted(homography: &DMat3, point: DVec2) -> DVec2 {
    let image = *homography * point.extend(1.0);
    image.truncate() / image.z
}

/// The derivative of [`tilted`].
fn tilted_slope(homography: &DMat3, point: DVec2) -> DMat2 {
    let image = *homography * point.extend(1.0);
    let at = image.truncate() / image.z;
    let column = |c: glam::DVec3| (c.truncate() - at * c.z) / image.z;
    DMat2::from_cols(column(homography.x_axis), column(homography.y_axis))
}
