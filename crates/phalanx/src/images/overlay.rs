//! Drawing what was seen and estimated over a picture.

use image::{Rgb, RgbImage};
use phalanx_segmentation::{CropWindow, Mask, Silhouette};
use phalanx_shape_context::hand_axis;

use crate::features::describer::{OrientationRule, WORKING_SIZE};
use crate::features::outline::trace_outline;
use crate::window::Window;

const OBSERVED: Rgb<u8> = Rgb([40, 220, 90]);
const AXIS: Rgb<u8> = Rgb([255, 210, 0]);
const ESTIMATED: Rgb<u8> = Rgb([230, 40, 160]);

/// Draws the contour of the observed silhouette (green), the axis to which `rule` turns it
/// (yellow; rules without one for all points draw none) and the contour of the estimated hand
/// (magenta) over a picture.
///
/// `window` is the part of `canvas` that the observed silhouette shows. Where the hand is in
/// space is not estimated from descriptors, which are blind to shift, scale and roll: the
/// estimated contour is brought onto the observed one by the similarity that matches the arms'
/// directions, centroids and areas.
pub fn draw_overlay(
    canvas: &mut RgbImage,
    window: CropWindow,
    observed: &Silhouette,
    rule: OrientationRule,
    estimated: Option<&Silhouette>,
) {
    let scale = f64::from(window.width) / f64::from(observed.mask.width());
    let to_canvas =
        |[x, y]: [f64; 2]| [x * scale + f64::from(window.x), y * scale + f64::from(window.y)];
    let mut pen = Pen { canvas, width: (scale * 0.6).max(1.0) };
    for piece in observed.contour.pieces() {
        pen.path(piece, to_canvas, OBSERVED);
    }
    if let Some(axis) = axis(observed, rule) {
        pen.path(&axis, to_canvas, AXIS);
    }
    if let Some(estimated) = estimated {
        let onto = Similarity::between(estimated, observed);
        for piece in estimated.contour.pieces() {
            pen.path(piece, |point| to_canvas(onto.apply(point)), ESTIMATED);
        }
    }
}

/// Draws the contour of a silhouette seen in a window (green) and that of the estimated hand, drawn
/// through the window's camera (magenta), over the picture that the window looks into.
pub fn draw_window_overlay(
    canvas: &mut RgbImage,
    window: &Window,
    observed: &Silhouette,
    estimated: Option<&Silhouette>,
) {
    // A window's pixel is about so wide in the picture.
    let scale = window.hand.length / (0.5 * f64::from(WORKING_SIZE.0));
    let mut pen = Pen { canvas, width: (scale * 0.6).max(1.0) };
    for (silhouette, colour) in
        [Some((observed, OBSERVED)), estimated.map(|own| (own, ESTIMATED))].into_iter().flatten()
    {
        for piece in silhouette.contour.pieces() {
            let shown: Vec<_> = piece.iter().filter_map(|&at| window.to_picture(at)).collect();
            pen.path(&shown, |point| point, colour);
        }
    }
}

/// The two ends of the axis that turns all points, where the rule has one.
fn axis(observed: &Silhouette, rule: OrientationRule) -> Option<[[f64; 2]; 2]> {
    match rule {
        OrientationRule::HandAxis => {
            let axis = hand_axis(&observed.contour.points, observed.forearm.end).ok()?;
            Some([axis.forearm_end, axis.tip])
        }
        OrientationRule::ForearmAxis => {
            let mut points = Vec::new();
            let axis = trace_outline(observed, &mut points).ok()?;
            let length = points.iter().map(|&point| axis.ahead(point)).fold(0.0, f64::max);
            Some([axis.start, [0, 1].map(|k| axis.start[k] + length * axis.direction[k])])
        }
        _ => None,
    }
}

/// The part of a picture that the working image shows.
///
/// # Errors
/// A picture without pixels.
pub fn working_window(picture: (u32, u32)) -> Result<CropWindow, phalanx_segmentation::Error> {
    CropWindow::centred(picture, WORKING_SIZE)
}

/// A turn, a scale and a shift of the plane.
struct Similarity {
    /// Scale times cosine and sine of the turn.
    turn: [f64; 2],
    from: [f64; 2],
    to: [f64; 2],
}

impl Similarity {
    /// From one silhouette onto another. The line from the forearm's end to the centroid is
    /// steadier than the hand axis, which jumps where another finger becomes the tip.
    fn between(from: &Silhouette, to: &Silhouette) -> Self {
        let (from_area, from_centroid) = area_and_centroid(from);
        let (to_area, to_centroid) = area_and_centroid(to);
        let angle = |of: &Silhouette, centroid: [f64; 2]| {
            (centroid[1] - of.forearm.end[1]).atan2(centroid[0] - of.forearm.end[0])
        };
        let angle = angle(to, to_centroid) - angle(from, from_centroid);
        let scale = (to_area / from_area).sqrt();
        Self {
            turn: [scale * angle.cos(), scale * angle.sin()],
            from: from_centroid,
            to: to_centroid,
        }
    }

    fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([c, s], [x, y]) = (self.turn, [x - self.from[0], y - self.from[1]]);
        [self.to[0] + c * x - s * y, self.to[1] + s * x + c * y]
    }
}

fn area_and_centroid(silhouette: &Silhouette) -> (f64, [f64; 2]) {
    let (mut area, mut sum) = (0.0, [0.0; 2]);
    for (x, y, level) in silhouette.mask.enumerate_pixels() {
        if Mask::is_hand_level(level.0[0]) {
            area += 1.0;
            sum[0] += f64::from(x) + 0.5;
            sum[1] += f64::from(y) + 0.5;
        }
    }
    (area, sum.map(|s| s / area))
}

struct Pen<'a> {
    canvas: &'a mut RgbImage,
    /// Side of its square tip, px.
    width: f64,
}

impl Pen<'_> {
    fn path(&mut self, points: &[[f64; 2]], map: impl Fn([f64; 2]) -> [f64; 2], colour: Rgb<u8>) {
        for pair in points.windows(2) {
            let [from, to] = [map(pair[0]), map(pair[1])];
            let steps = (2.0 * (to[0] - from[0]).hypot(to[1] - from[1])).ceil().max(1.0);
            for step in 0..=steps as u32 {
                let t = f64::from(step) / steps;
                self.dot(from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]), colour);
            }
        }
    }

    fn dot(&mut self, x: f64, y: f64, colour: Rgb<u8>) {
        let range = |centre: f64, end: u32| {
            let low = (centre - 0.5 * self.width).round().max(0.0) as u32;
            low..((centre + 0.5 * self.width).round().max(0.0) as u32).min(end)
        };
        for row in range(y, self.canvas.height()) {
            for column in range(x, self.canvas.width()) {
                self.canvas.put_pixel(column, row, colour);
            }
        }
    }
}
