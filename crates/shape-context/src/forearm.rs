use crate::error::{Error, Result};
use crate::limits::MIN_MEAN_DISTANCE;
use crate::points::{centroid, check_points, cross, dot, in_range, norm, perpendicular, sub, unit};

/// The axis of the forearm, and where a cut across it meets both of its sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForearmAxis {
    /// The middle of the cut, in pixels.
    pub start: [f64; 2],
    /// The axis's unit vector, towards the hand.
    pub direction: [f64; 2],
    /// The distance of the sides across the axis, in pixels.
    pub width: f64,
}

/// How much of the forearm tells its direction, in widths.
const REACH: f64 = 1.5;

/// The stretch that is looked at turns with the direction that is found in it.
const ROUNDS: usize = 2;

/// Relative size below which a spread is taken for zero, and a point for one on the cut or on the axis.
const NEGLIGIBLE: f64 = 1e-9;

impl ForearmAxis {
    /// The axis's angle in radians, −π to π, turning from +x towards +y: clockwise on a screen.
    pub fn angle(&self) -> f64 {
        self.direction[1].atan2(self.direction[0])
    }

    /// How far ahead of the cut a point lies, in pixels.
    pub fn ahead(&self, point: [f64; 2]) -> f64 {
        dot(sub(point, self.start), self.direction)
    }

    /// Whether a point lies on the hand's side of the cut, or on it.
    pub fn is_ahead(&self, point: [f64; 2]) -> bool {
        self.ahead(point) >= -NEGLIGIBLE * self.width
    }

    /// The axis in this direction, cut where it has both sides.
    fn across(sides: [[f64; 2]; 2], direction: [f64; 2]) -> Result<Self> {
        let half = sub(sides[1], sides[0]).map(|c| c / 2.0);
        let width = 2.0 * cross(direction, half).abs();
        if width < MIN_MEAN_DISTANCE {
            return Err(Error::NoForearmAxis);
        }
        let ahead = dot(half, direction).abs();
        let start = [0, 1].map(|k| sides[0][k] + half[k] + ahead * direction[k]);
        Ok(Self { start, direction, width })
    }

    /// The direction common to both sides of the forearm, by least squares with an offset of its
    /// own for each. A point counts less the further ahead, down to nothing, so that none makes
    /// a difference by coming into reach.
    fn along_sides(&self, points: &[[f64; 2]]) -> Result<[f64; 2]> {
        let across = perpendicular(self.direction);
        let mut sides = [Side::default(); 2];
        for &point in points.iter().filter(|&&point| self.is_ahead(point)) {
            let (s, t) = (self.ahead(point), dot(sub(point, self.start), across));
            let weight = 1.0 - s / (REACH * self.width);
            // Of a point on the axis rounding would decide which side it is of.
            if weight > 0.0 && t.abs() > NEGLIGIBLE * self.width {
                sides[usize::from(t > 0.0)].add(weight, s, t);
            }
        }
        let [left, right] = sides.map(Side::moments);
        let (ss, st) = (left[0] + right[0], left[1] + right[1]);
        // Sides without a point make it NaN.
        if ss > NEGLIGIBLE * self.width * self.width {
            Ok(unit([0, 1].map(|k| ss * self.direction[k] + st * across[k])))
        } else {
            Err(Error::NoForearmAxis)
        }
    }
}

/// Sums over the points of one side of the forearm: weights, along it, across it, and products.
#[derive(Clone, Copy, Default)]
struct Side {
    weight: f64,
    s: f64,
    t: f64,
    ss: f64,
    st: f64,
}

impl Side {
    fn add(&mut self, weight: f64, s: f64, t: f64) {
        self.weight += weight;
        self.s += weight * s;
        self.t += weight * t;
        self.ss += weight * s * s;
        self.st += weight * s * t;
    }

    /// Second moments about the mean: along, and along times across.
    fn moments(self) -> [f64; 2] {
        [self.ss - self.s * self.s / self.weight, self.st - self.s * self.t / self.weight]
    }
}

/// The axis of the forearm by its two sides, so that no finger moves it.
///
/// `sides` are where the forearm's sides begin, as where a picture's border cuts them, in either
/// order. The direction is that of the contour along one and a half widths of the forearm ahead of
/// them; points behind do not count. Where the border cuts obliquely, one side begins further
/// back: [`ForearmAxis::is_ahead`] tells what a cut squarely across leaves.
///
/// # Errors
/// Too few or too many points, a coordinate out of range, sides in one place or without a point
/// along them.
///
/// ```
/// use phalanx_shape_context::forearm_axis;
///
/// // An arm 8 px wide, upwards from the picture's lower border; its hand leans to the right.
/// let left = (0..40).rev().map(|y| [10.0, f64::from(y)]);
/// let hand = [[12.0, -6.0], [24.0, -20.0], [20.0, -4.0]];
/// let right = (0..40).map(|y| [18.0, f64::from(y)]);
/// let contour: Vec<_> = left.chain(hand).chain(right).collect();
/// let axis = forearm_axis(&contour, [[10.0, 40.0], [18.0, 40.0]])?;
/// assert!((axis.width - 8.0).abs() < 1e-6 && (axis.direction[1] + 1.0).abs() < 1e-6);
/// assert!(axis.is_ahead([14.0, 39.0]) && !axis.is_ahead([14.0, 41.0]));
/// # Ok::<(), phalanx_shape_context::Error>(())
/// ```
pub fn forearm_axis(points: &[[f64; 2]], sides: [[f64; 2]; 2]) -> Result<ForearmAxis> {
    check_points(points)?;
    if let Some([x, y]) = sides.into_iter().find(|&side| !in_range(side)) {
        return Err(Error::BadForearmEnd { x, y });
    }
    let middle = [0, 1].map(|k| f64::midpoint(sides[0][k], sides[1][k]));
    let towards_hand = sub(centroid(points), middle);
    if norm(towards_hand) < MIN_MEAN_DISTANCE {
        return Err(Error::NoForearmAxis);
    }
    let mut axis = ForearmAxis::across(sides, unit(towards_hand))?;
    for _ in 0..ROUNDS {
        axis = ForearmAxis::across(sides, axis.along_sides(points)?)?;
    }
    Ok(axis)
}
