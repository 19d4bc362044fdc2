use crate::error::{Error, Result};
use crate::limits::{MAX_COORDINATE, MAX_POINTS, MIN_POINTS};

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
