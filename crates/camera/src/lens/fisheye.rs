//! Fisheye lenses: OpenCV's four-coefficient model and its inverse.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::lens::positive::is_positive;

/// A fisheye lens as in OpenCV's `fisheye` module, Kalibr's `equidistant` and COLMAP's
/// `OPENCV_FISHEYE` (J. Kannala, S. Brandt, 2006, *A generic camera model and calibration method for
/// conventional, wide-angle, and fish-eye lenses*): a direction at the angle θ from the axis is seen
/// at the radius
///
/// θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸).
///
/// Directions are points of the normalised plane, so that those of 90° and more are not seen.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Fisheye {
    /// Third order.
    pub k1: f64,
    /// Fifth order.
    pub k2: f64,
    /// Seventh order.
    pub k3: f64,
    /// Ninth order.
    pub k4: f64,
}

impl Fisheye {
    /// Accuracy of [`undistort`](Self::undistort), relative to the plane's unit.
    const TOLERANCE: f64 = 1e-12;

    /// From none or all four coefficients, k1 k2 k3 k4; `None` for any other number of them.
    pub fn from_coefficients(coefficients: &[f64]) -> Option<Self> {
        match *coefficients {
            [] => Some(Self::default()),
            [k1, k2, k3, k4] => Some(Self { k1, k2, k3, k4 }),
            _ => None,
        }
    }

    /// Where the lens puts a point of the normalised plane.
    pub fn distort(&self, point: DVec2) -> DVec2 {
        let radius = point.length();
        // The factor's limit at the middle is 1.
        if radius < 1e-9 { point } else { point * (self.radius(radius.atan()) / radius) }
    }

    /// The point of the normalised plane that the lens puts at `distorted`, by damped Newton steps
    /// on the angle; `None` where there is none short of the fold or of 90°.
    ///
    /// ```
    /// use glam::DVec2;
    /// use phalanx_camera::Fisheye;
    ///
    /// let lens = Fisheye { k1: -0.0059, k2: 0.0159, k3: -0.0242, k4: 0.0155 };
    /// let point = DVec2::new(1.5, -2.0); // 68° off the axis
    /// assert!((lens.undistort(lens.distort(point)).expect("it is seen") - point).length() < 1e-9);
    /// assert_eq!(lens.undistort(DVec2::X * 3.0), None);
    /// ```
    pub fn undistort(&self, distorted: DVec2) -> Option<DVec2> {
        let wanted = distorted.length();
        if wanted < 1e-9 {
            return Some(distorted);
        }
        let tolerance = Self::TOLERANCE * (1.0 + wanted);
        let (mut angle, mut error) = (0.0_f64, -wanted);
        for _ in 0..60 {
            if error.abs() <= tolerance {
                return Some(distorted * (angle.tan() / wanted));
            }
            let step = error / self.slope(angle);
            (angle, error) = (0..40).find_map(|halvings| {
                let next = angle - step * 0.5f64.powi(halvings);
                let next_error = self.radius(next) - wanted;
                let better = next_error.abs() < error.abs();
                (better && self.grows_up_to(next)).then_some((next, next_error))
            })?;
        }
        None
    }

    /// Whether the lens has not folded over at this point of the normalised plane.
    pub fn is_one_to_one_at(&self, point: DVec2) -> bool {
        self.grows_up_to(point.length().atan())
    }

    /// Whether the radius grows from the axis to this angle, and the angle is less than 90°.
    fn grows_up_to(&self, angle: f64) -> bool {
        let coefficients = [1.0, 3.0 * self.k1, 5.0 * self.k2, 7.0 * self.k3, 9.0 * self.k4];
        (0.0..std::f64::consts::FRAC_PI_2).contains(&angle)
            && is_positive(coefficients, angle * angle)
    }

    /// The radius at which an angle is seen.
    fn radius(&self, angle: f64) -> f64 {
        let s = angle * angle;
        angle * (1.0 + s * (self.k1 + s * (self.k2 + s * (self.k3 + s * self.k4))))
    }

    /// The derivative of [`radius`](Self::radius).
    fn slope(&self, angle: f64) -> f64 {
        let s = angle * angle;
        1.0 + s * (3.0 * self.k1 + s * (5.0 * self.k2 + s * (7.0 * self.k3 + s * 9.0 * self.k4)))
    }
}
