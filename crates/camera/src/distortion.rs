//! The lens: OpenCV's five-coefficient model (Brown, 1966) and its inverse.

use glam::{DMat2, DVec2};
use serde::{Deserialize, Serialize};

/// Radial and tangential distortion of the normalised image plane (z = 1), as in OpenCV:
///
/// x′ = x (1 + k1 r² + k2 r⁴ + k3 r⁶) + 2 p1 x y + p2 (r² + 2x²),
/// y′ = y (1 + k1 r² + k2 r⁴ + k3 r⁶) + p1 (r² + 2y²) + 2 p2 x y.
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
}

impl Distortion {
    /// A perfect lens.
    pub const NONE: Self = Self { k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 };

    /// Accuracy of [`undistort`](Self::undistort), relative to the plane's unit.
    const TOLERANCE: f64 = 1e-12;

    /// Whether the lens is perfect.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Where the lens puts a point of the normalised plane.
    pub fn distort(&self, point: DVec2) -> DVec2 {
        let (x, y) = (point.x, point.y);
        let s = point.length_squared();
        let tangential = DVec2::new(
            2.0 * self.p1 * x * y + self.p2 * (s + 2.0 * x * x),
            self.p1 * (s + 2.0 * y * y) + 2.0 * self.p2 * x * y,
        );
        point * self.radial(s) + tangential
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
        let tolerance = Self::TOLERANCE * (1.0 + distorted.length());
        let mut point = DVec2::ZERO;
        let mut error = -distorted;
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

    /// Whether the lens has not folded over at this point of the normalised plane: the radial
    /// part grows all the way from the middle of the picture to it.
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
        // d/dr of r (1 + k1 r² + k2 r⁴ + k3 r⁶) is a cubic in s = r²; its least value up to s
        // is at s or at one of its two extrema.
        let slope = |s: f64| 1.0 + s * (3.0 * self.k1 + s * (5.0 * self.k2 + s * 7.0 * self.k3));
        let extrema = quadratic_roots(21.0 * self.k3, 10.0 * self.k2, 3.0 * self.k1);
        let s = point.length_squared();
        slope(s) > 0.0 && extrema.iter().all(|&e| !(0.0..s).contains(&e) || slope(e) > 0.0)
    }

    /// The radial factor at squared radius `s`.
    fn radial(&self, s: f64) -> f64 {
        1.0 + s * (self.k1 + s * (self.k2 + s * self.k3))
    }

    /// The derivative of [`distort`](Self::distort).
    fn jacobian(&self, point: DVec2) -> DMat2 {
        let (x, y) = (point.x, point.y);
        let s = point.length_squared();
        let radial = self.radial(s);
        // The radial factor's gradient is `growth` times the point.
        let growth = 2.0 * (self.k1 + s * (2.0 * self.k2 + s * 3.0 * self.k3));
        let cross = growth * x * y + 2.0 * (self.p1 * x + self.p2 * y);
        let xx = radial + growth * x * x + 2.0 * self.p1 * y + 6.0 * self.p2 * x;
        let yy = radial + growth * y * y + 6.0 * self.p1 * y + 2.0 * self.p2 * x;
        DMat2::from_cols(DVec2::new(xx, cross), DVec2::new(cross, yy))
    }
}

/// Real roots of a s² + b s + c, not finite where there are none.
fn quadratic_roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    [q / a, c / q]
}
