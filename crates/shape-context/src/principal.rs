use crate::error::{Error, Result};
use crate::points::{centroid, dot, perpendicular, sub};

/// Relative size below which a moment is taken for zero: far above rounding, far below any shape.
const NEGLIGIBLE: f64 = 1e-9;

/// The unit vector along which the points spread most, its sense given by their skewness.
///
/// The covariance leaves the sense open. It is chosen so that the third moment along the axis is
/// positive (the longer tail lies ahead); when that vanishes, the other third moments decide in
/// turn. All of them change sign under a half turn, so the choice follows any rotation. When all
/// vanish the figure is its own half turn, to third order, and either sense will do.
pub(crate) fn principal_axis(points: &[[f64; 2]], mean_distance: f64) -> Result<[f64; 2]> {
    let centre = centroid(points);
    let offsets = points.iter().map(|&p| sub(p, centre).map(|c| c / mean_distance));
    let [mut xx, mut xy, mut yy] = [0.0; 3];
    for [x, y] in offsets.clone() {
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    if (xx - yy).hypot(2.0 * xy) <= NEGLIGIBLE * (xx + yy) {
        return Err(Error::NoPrincipalAxis);
    }
    let (sin, cos) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
    let axis = [cos, sin];

    let mut moments = [0.0; 4];
    for offset in offsets {
        let (s, t) = (dot(offset, axis), dot(offset, perpendicular(axis)));
        let terms = [s * s * s, s * s * t, s * t * t, t * t * t];
        moments.iter_mut().zip(terms).for_each(|(m, term)| *m += term);
    }
    let floor = NEGLIGIBLE * points.len() as f64;
    let backwards = moments.iter().find(|m| m.abs() > floor).is_some_and(|&m| m < 0.0);
    Ok(if backwards { axis.map(|c| -c) } else { axis })
}
