use crate::error::{Error, Result};
use crate::points::{centroid, check_points, cross, dot, in_range, sub, unit};

/// The hand axis: from the forearm's end to the tip of the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The forearm's end, as given, in pixels.
    pub forearm_end: [f64; 2],
    /// The contour point furthest from it, in pixels.
    pub tip: [f64; 2],
    /// The tip's index in the contour.
    pub tip_index: usize,
}

impl Axis {
    /// The axis's unit vector, from the forearm to the tip.
    pub fn direction(&self) -> [f64; 2] {
        unit(sub(self.tip, self.forearm_end))
    }

    /// The axis's angle in radians, −π to π, turning from +x towards +y: clockwise on a screen.
    pub fn angle(&self) -> f64 {
        let [x, y] = sub(self.tip, self.forearm_end);
        y.atan2(x)
    }
}

/// Distances whose squares differ by less than this fraction are a tie.
const TIE: f64 = 1e-9;

/// The hand axis of a contour (de Campos and Murray, 2006, section 2): the contour point furthest
/// from the forearm's end is the tip.
///
/// Of several points at the same greatest distance, as happens on a pixel grid, the most clockwise
/// one as seen from the forearm's end facing the centroid is taken, so that neither the order of
/// the points nor a rotation of the image decides.
///
/// # Errors
/// Too few or too many points, a coordinate out of range, or all points on the forearm's end.
///
/// ```
/// use phalanx_shape_context::hand_axis;
///
/// let finger = [[4.0, 9.0], [4.0, 2.0], [5.0, 0.0], [6.0, 2.0], [6.0, 9.0]];
/// let axis = hand_axis(&finger, [5.0, 9.0])?;
/// assert_eq!((axis.tip, axis.tip_index, axis.direction()), ([5.0, 0.0], 2, [0.0, -1.0]));
/// # Ok::<(), phalanx_shape_context::Error>(())
/// ```
pub fn hand_axis(points: &[[f64; 2]], forearm_end: [f64; 2]) -> Result<Axis> {
    check_points(points)?;
    if !in_range(forearm_end) {
        return Err(Error::BadForearmEnd { x: forearm_end[0], y: forearm_end[1] });
    }
    let squared = |p: &[f64; 2]| dot(sub(*p, forearm_end), sub(*p, forearm_end));
    let furthest = points.iter().map(squared).fold(0.0, f64::max);
    if furthest < f64::MIN_POSITIVE {
        return Err(Error::NoHandAxis);
    }
    let ahead = sub(centroid(points), forearm_end);
    let tied = points.iter().enumerate().filter(|(_, p)| squared(p) >= furthest * (1.0 - TIE));
    let clockwise = |p: &[f64; 2]| cross(ahead, sub(*p, forearm_end));
    tied.max_by(|(_, a), (_, b)| clockwise(a).total_cmp(&clockwise(b)))
        .map(|(tip_index, &tip)| Axis { forearm_end, tip, tip_index })
        .ok_or(Error::NoHandAxis)
}
