use crate::{Error, Result, pairs};

/// The fewest points that make a shape.
pub const MIN_POINTS: usize = 3;

/// The most points accepted: time grows with their square (a second or so at this limit).
pub const MAX_POINTS: usize = 20_000;

/// The largest coordinate accepted, in pixels, so that no product of a few of them overflows.
pub const MAX_COORDINATE: f64 = 1e9;

/// The smallest mean distance, in pixels, that counts as an extent.
pub const MIN_MEAN_DISTANCE: f64 = 1e-9;

/// The mean distance μ over all pairs of the points, in pixels: the scale of their shape contexts.
///
/// # Errors
/// Too few or too many points, a coordinate out of range, or all points in one place.
///
/// ```
/// // The three sides of a triangle.
/// let mean = phalanx_shape_context::mean_distance(&[[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]])?;
/// assert!((mean - 4.0).abs() < 1e-12);
/// # Ok::<(), phalanx_shape_context::Error>(())
/// ```
pub fn mean_distance(points: &[[f64; 2]]) -> Result<f64> {
    let mut columns = Columns::default();
    columns.load(points)?;
    columns.mean_distance()
}

/// The coordinates of checked points in two runs, as vector instructions like them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Columns {
    pub(crate) xs: Vec<f64>,
    pub(crate) ys: Vec<f64>,
}

impl Columns {
    pub(crate) fn load(&mut self, points: &[[f64; 2]]) -> Result<()> {
        check_points(points)?;
        self.xs.clear();
        self.ys.clear();
        self.xs.extend(points.iter().map(|p| p[0]));
        self.ys.extend(points.iter().map(|p| p[1]));
        Ok(())
    }

    pub(crate) fn mean_distance(&self) -> Result<f64> {
        let n = self.xs.len();
        let pairs = (n * (n - 1) / 2) as f64;
        let mean_distance = pairs::distance_sum(self) / pairs;
        if mean_distance < MIN_MEAN_DISTANCE {
            return Err(Error::Coincident { mean_distance });
        }
        Ok(mean_distance)
    }
}

pub(crate) fn check_points(points: &[[f64; 2]]) -> Result<()> {
    if points.len() < MIN_POINTS {
        return Err(Error::TooFewPoints { points: points.len() });
    }
    if points.len() > MAX_POINTS {
        return Err(Error::TooManyPoints { points: points.len() });
    }
    match points.iter().position(|&p| !in_range(p)) {
        Some(point) => Err(Error::BadPoint { point, x: points[point][0], y: points[point][1] }),
        None => Ok(()),
    }
}

pub(crate) fn in_range(point: [f64; 2]) -> bool {
    // A NaN compares false.
    point.iter().all(|c| c.abs() <= MAX_COORDINATE)
}

pub(crate) fn centroid(points: &[[f64; 2]]) -> [f64; 2] {
    let n = points.len() as f64;
    let sum = points.iter().fold([0.0; 2], |s, p| [s[0] + p[0], s[1] + p[1]]);
    sum.map(|s| s / n)
}

pub(crate) fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Positive when `b` lies on the +y side of `a`, +x being ahead: clockwise on a screen.
pub(crate) fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The length; squares do not underflow.
pub(crate) fn norm(a: [f64; 2]) -> f64 {
    a[0].hypot(a[1])
}

/// The direction of anything but zero, however small.
pub(crate) fn unit(a: [f64; 2]) -> [f64; 2] {
    let largest = a[0].abs().max(a[1].abs());
    let scaled = a.map(|component| component / largest);
    let length = norm(scaled);
    scaled.map(|component| component / length)
}

/// A quarter turn from +x towards +y.
pub(crate) fn perpendicular(a: [f64; 2]) -> [f64; 2] {
    [-a[1], a[0]]
}
