//! The forearm's end where it does not leave the image: the smooth end of the silhouette.

use crate::mask::Mask;

use crate::error::{Error, Result};
use crate::silhouette::contour::Contour;

/// Standard deviations along the principal axes of a silhouette with two ends differ by this.
const LEAST_ELONGATION: f64 = 1.15;

/// The share of the silhouette's length at either end that is looked at.
const END: f64 = 0.3;

/// The share of the length over which the position of the end is averaged.
const TIP: f64 = 0.05;

/// An end with more is fingers. Half a disc has 2π, a square stump 9, a lone finger 13 and more.
const SMOOTH: f64 = 11.0;

/// Ends must differ by this factor in what tells them apart.
const LEAST_RATIO: f64 = 1.1;

/// One end of the silhouette along its principal axis.
#[derive(Debug, Clone, Copy, Default)]
struct End {
    area: usize,
    contour_points: usize,
    tip_sum: [f64; 2],
    tip_count: usize,
    /// How far it reaches along the axis.
    depth: f64,
}

impl End {
    /// Squared number of contour points per pixel of area: the same at any scale.
    fn raggedness(&self) -> f64 {
        (self.contour_points as f64).powi(2) / self.area as f64
    }

    fn width(&self) -> f64 {
        self.area as f64 / self.depth
    }
}

/// The end of a forearm that is in the picture, in pixels.
pub(crate) struct SmoothEnd {
    /// Its middle.
    pub(crate) end: [f64; 2],
    /// Either side of the middle, at the forearm's mean width.
    pub(crate) sides: [[f64; 2]; 2],
}

/// The end that is a smooth stump rather than fingers. Of two smooth ends, such as
/// those of a fist, the forearm is the narrower one.
pub(crate) fn find_smooth_end(mask: &Mask, contour: &Contour) -> Result<SmoothEnd> {
    let axis = PrincipalAxis::of(mask);
    let ends = axis.ends(mask, contour);
    let raggedness = ends.map(|end| end.raggedness());
    let areas = ends.map(|end| end.area);
    let measures = if raggedness[0].max(raggedness[1]) > SMOOTH {
        raggedness
    } else {
        areas.map(|a| a as f64)
    };
    let ratio = measures[0].max(measures[1]) / measures[0].min(measures[1]);
    if axis.elongation < LEAST_ELONGATION || ratio < LEAST_RATIO {
        return Err(Error::NoForearm { elongation: axis.elongation, raggedness, areas });
    }
    let forearm = ends[usize::from(measures[1] < measures[0])];
    let end = forearm.tip_sum.map(|sum| sum / forearm.tip_count as f64);
    let [dx, dy] = axis.direction.map(|c| c * forearm.width() / 2.0);
    Ok(SmoothEnd { end, sides: [[end[0] - dy, end[1] + dx], [end[0] + dy, end[1] - dx]] })
}

struct PrincipalAxis {
    middle: [f64; 2],
    direction: [f64; 2],
    elongation: f64,
}

fn hand_middles(mask: &Mask) -> impl Iterator<Item = [f64; 2]> {
    mask.hand_pixels().map(|pixel| pixel.map(|at| f64::from(at) + 0.5))
}

impl PrincipalAxis {
    fn of(mask: &Mask) -> Self {
        let (mut count, mut sum) = (0.0, [0.0; 2]);
        for [x, y] in hand_middles(mask) {
            count += 1.0;
            sum = [sum[0] + x, sum[1] + y];
        }
        let middle = sum.map(|sum| sum / count);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for [x, y] in hand_middles(mask) {
            let (dx, dy) = (x - middle[0], y - middle[1]);
            (xx, xy, yy) = (xx + dx * dx, xy + dx * dy, yy + dy * dy);
        }
        let spread = f64::midpoint(xx, -yy).hypot(xy);
        let mean = f64::midpoint(xx, yy);
        // A pixel is one unit wide: its own variance keeps a line from being infinitely slim.
        let pixel = count / 12.0;
        let elongation = ((mean + spread + pixel) / ((mean - spread).max(0.0) + pixel)).sqrt();
        let (sin, cos) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
        Self { middle, direction: [cos, sin], elongation }
    }

    fn along(&self, [x, y]: [f64; 2]) -> f64 {
        (x - self.middle[0]) * self.direction[0] + (y - self.middle[1]) * self.direction[1]
    }

    /// Both ends, that against the direction first. Each has at least one pixel.
    fn ends(&self, mask: &Mask, contour: &Contour) -> [End; 2] {
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for pixel in hand_middles(mask) {
            let along = self.along(pixel);
            (low, high) = (low.min(along), high.max(along));
        }
        let length = high - low;
        let depths = |pixel| {
            let along = self.along(pixel);
            [along - low, high - along]
        };
        let mut ends = [End { depth: END * length, ..End::default() }; 2];
        for pixel in hand_middles(mask) {
            for (end, depth) in ends.iter_mut().zip(depths(pixel)) {
                end.area += usize::from(depth <= END * length);
                if depth <= TIP * length {
                    end.tip_sum = [end.tip_sum[0] + pixel[0], end.tip_sum[1] + pixel[1]];
                    end.tip_count += 1;
                }
            }
        }
        for &point in &contour.points {
            for (end, depth) in ends.iter_mut().zip(depths(point)) {
                end.contour_points += usize::from(depth <= END * length);
            }
        }
        ends
    }
}
