//! A mask as another camera at the same place sees it.

use std::ops::Range;

use glam::DVec2;
use phalanx_camera::PixelMap;
use phalanx_segmentation::Mask;

/// Samples along a row between places where the map is evaluated; it is straight in between, to far
/// less than a pixel.
const STRETCH: u32 = 8;

/// The most samples along a side of a window's pixel.
const MOST_SAMPLES: u32 = 4;

/// Side of the blocks of pixels that are looked at together first; as wide as a stretch or several, however many
/// samples there are to a pixel.
const BLOCK: u32 = STRETCH;

/// How far around a block its samples may tell of, px of the mask: half a pixel by nearness, and the rest for what a
/// lens bends within a block.
const AROUND: f64 = 2.0;

/// Fills `seen` with the mask under a map from its pixels to the mask's: 255 where the mask covers at
/// least half of a pixel. There is nothing outside the mask.
pub(crate) fn resample(mask: &Mask, to_mask: &PixelMap, seen: &mut Mask) {
    let (width, height) = seen.dimensions();
    let samples = samples_aside(to_mask, (width, height));
    let mut row = Vec::with_capacity((BLOCK * samples) as usize);
    let pixels: &mut [u8] = seen;
    for top in (0..height).step_by(BLOCK as usize) {
        for left in (0..width).step_by(BLOCK as usize) {
            let (right, bottom) = (width.min(left + BLOCK), height.min(top + BLOCK));
            let corners = [(left, top), (right, top), (left, bottom), (right, bottom)];
            let corners = corners.map(|(x, y)| to_mask.map(DVec2::new(x.into(), y.into())));
            // Most blocks are all hand or all background.
            let alike = alike_around(mask, corners);
            for y in top..bottom {
                let start = (y * width + left) as usize;
                let line = &mut pixels[start..start + (right - left) as usize];
                match alike {
                    Some(hand) => line.fill(hand),
                    None => sample(mask, to_mask, [left, y], samples, &mut row, line),
                }
            }
        }
    }
}

/// The one level of the mask, 0 or 255, in the rectangle around four places and somewhat further; `None` where it
/// has both, or a place is nowhere.
fn alike_around(mask: &Mask, places: [Option<DVec2>; 4]) -> Option<u8> {
    let mut low = DVec2::INFINITY;
    let mut high = DVec2::NEG_INFINITY;
    for place in places {
        (low, high) = (low.min(place?), high.max(place?));
    }
    let size = DVec2::new(f64::from(mask.width()), f64::from(mask.height()));
    let (low, high) = (low - AROUND, high + AROUND);
    let is_within = low.cmpge(DVec2::ZERO).all() && high.cmple(size).all();
    let (low, high) = (low.clamp(DVec2::ZERO, size), high.clamp(DVec2::ZERO, size));
    let columns = low.x as usize..high.x.ceil() as usize;
    let width = mask.width() as usize;
    let rows = low.y as usize..high.y.ceil() as usize;
    let mut rows = rows.map(|y| &mask.as_raw()[y * width..][columns.clone()]);
    // There is nothing outside the mask.
    let hand = is_within && rows.clone().next().is_some_and(|row| row[0] > 127);
    // Whole rows at once: most are alike.
    let is_alike = |row: &[u8]| {
        let differing =
            row.iter().fold(0, |differing, &pixel| differing | u8::from((pixel > 127) != hand));
        differing == 0
    };
    rows.all(is_alike).then_some(255 * u8::from(hand))
}

/// Fills part of a row of pixels, from one on, so many samples along each side of a pixel.
fn sample(
    mask: &Mask,
    to_mask: &PixelMap,
    [left, y]: [u32; 2],
    samples: u32,
    row: &mut Vec<DVec2>,
    line: &mut [u8],
) {
    let mut sums = [0.0; BLOCK as usize];
    let columns = samples * left..samples * (left + line.len() as u32);
    for k in 0..samples {
        let y = f64::from(y) + (f64::from(k) + 0.5) / f64::from(samples);
        positions(to_mask, y, columns.clone(), f64::from(samples), row);
        for (sum, positions) in sums.iter_mut().zip(row.chunks_exact(samples as usize)) {
            *sum += positions.iter().map(|&position| level(mask, position)).sum::<f64>();
        }
    }
    let half = 0.5 * f64::from(samples * samples);
    for (pixel, sum) in line.iter_mut().zip(sums) {
        *pixel = if sum >= half { 255 } else { 0 };
    }
}

/// Which pixels of a window of some size lie in the picture, wholly and with a neighbour: 255, all
/// others 0.
pub(crate) fn inside(
    to_picture: &PixelMap,
    (width, height): (u32, u32),
    picture: (u32, u32),
) -> Mask {
    let least = DVec2::splat(1.5 * pixels_aside(to_picture, (width, height)));
    let most = DVec2::new(f64::from(picture.0), f64::from(picture.1)) - least;
    let mut row = Vec::with_capacity(width as usize);
    let mut inside = Mask::new(width, height);
    for (y, line) in inside.chunks_exact_mut(width as usize).enumerate() {
        positions(to_picture, y as f64 + 0.5, 0..width, 1.0, &mut row);
        for (pixel, at) in line.iter_mut().zip(&row) {
            // A NaN is not inside.
            *pixel = if at.cmpge(least).all() && at.cmple(most).all() { 255 } else { 0 };
        }
    }
    inside
}

/// Leaves nothing of a mask outside the picture, of this width and height, that its pixels are mapped to.
pub(super) fn cut(mask: &mut Mask, to_picture: &PixelMap, picture: DVec2) {
    let width = mask.width();
    let mut row = Vec::with_capacity(width as usize);
    for (y, line) in mask.chunks_exact_mut(width as usize).enumerate() {
        positions(to_picture, y as f64 + 0.5, 0..width, 1.0, &mut row);
        for (pixel, at) in line.iter_mut().zip(&row) {
            // A NaN is not inside.
            if !(at.cmpge(DVec2::ZERO).all() && at.cmple(picture).all()) {
                *pixel = 0;
            }
        }
    }
}

/// Samples along a side of a pixel: as many as it covers of the mask's pixels.
fn samples_aside(to_mask: &PixelMap, size: (u32, u32)) -> u32 {
    (pixels_aside(to_mask, size).ceil() as u32).clamp(1, MOST_SAMPLES)
}

/// How many of the mask's pixels a pixel in the middle of a window of some size covers along a side.
pub(crate) fn pixels_aside(to_mask: &PixelMap, (width, height): (u32, u32)) -> f64 {
    let middle = DVec2::new(f64::from(width), f64::from(height)) / 2.0;
    let ends = [-0.5, 0.5].map(|offset| to_mask.map(middle + DVec2::X * offset));
    let [Some(from), Some(to)] = ends else { return 1.0 };
    from.distance(to)
}

/// Where some samples of a row, so many to the pixel, lie in the mask; NaN where nowhere. They begin with a stretch.
fn positions(
    to_mask: &PixelMap,
    y: f64,
    samples: Range<u32>,
    per_pixel: f64,
    row: &mut Vec<DVec2>,
) {
    let at = |sample: u32| {
        let x = (f64::from(sample) + 0.5) / per_pixel;
        to_mask.map(DVec2::new(x, y)).unwrap_or(DVec2::NAN)
    };
    row.clear();
    let mut from = at(samples.start);
    for first in samples.clone().step_by(STRETCH as usize) {
        let to = at(first + STRETCH);
        let step = (to - from) / f64::from(STRETCH);
        let ahead = STRETCH.min(samples.end - first);
        row.extend((0..ahead).map(|k| from + step * f64::from(k)));
        from = to;
    }
}

/// How much of the mask's pixels around a position is hand, 0 to 1, weighted by nearness.
fn level(mask: &Mask, position: DVec2) -> f64 {
    let corner = position - 0.5;
    let (width, height) = (f64::from(mask.width()), f64::from(mask.height()));
    // A NaN is not inside.
    let inside = corner.x > -1.0 && corner.y > -1.0 && corner.x < width && corner.y < height;
    if !inside {
        return 0.0;
    }
    let first = DVec2::new(floor(corner.x), floor(corner.y));
    let share = corner - first;
    let (x, y) = (first.x as i64, first.y as i64);
    if x >= 0 && y >= 0 && x + 1 < i64::from(mask.width()) && y + 1 < i64::from(mask.height()) {
        let at = y as usize * mask.width() as usize + x as usize;
        let (above, below) = (&mask.as_raw()[at..], &mask.as_raw()[at + mask.width() as usize..]);
        let corners = [above[0], above[1], below[0], below[1]].map(|pixel| pixel > 127);
        // Most places are all hand or all background.
        if corners.iter().all(|&hand| hand == corners[0]) {
            return f64::from(u8::from(corners[0]));
        }
    }
    let hand = |dx: i64, dy: i64| {
        let (x, y) = (x + dx, y + dy);
        let within =
            (0..i64::from(mask.width())).contains(&x) && (0..i64::from(mask.height())).contains(&y);
        if within && mask.is_hand(x as u32, y as u32) { 1.0 } else { 0.0 }
    };
    let row = |dy: i64| (1.0 - share.x) * hand(0, dy) + share.x * hand(1, dy);
    (1.0 - share.y) * row(0) + share.y * row(1)
}

/// The integer below, without a call to the mathematics library.
fn floor(x: f64) -> f64 {
    let towards_zero = x as i64 as f64;
    if towards_zero > x { towards_zero - 1.0 } else { towards_zero }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use phalanx_camera::{Camera, Distortion, Intrinsics};
    use proptest::prelude::*;

    use super::*;

    /// The same with every pixel sampled.
    fn slow(mask: &Mask, to_mask: &PixelMap, seen: &mut Mask) {
        let (width, height) = seen.dimensions();
        let samples = samples_aside(to_mask, (width, height));
        for (y, line) in seen.chunks_exact_mut(width as usize).enumerate() {
            for (k, piece) in line.chunks_mut(BLOCK as usize).enumerate() {
                let first = [BLOCK * k as u32, y as u32];
                sample(mask, to_mask, first, samples, &mut Vec::new(), piece);
            }
        }
    }

    proptest! {
        #![proptest_config(crate::property::cases(64))]

        /// A disc before a wide lens, in and beyond its picture.
        #[test]
        fn blocks_that_are_alike_need_no_samples(
            disc in (-40.0..360.0_f64, -40.0..280.0_f64, 5.0..150.0_f64),
            ahead in prop::array::uniform2(-0.6..0.6_f64),
            focal in 40.0..500.0_f64,
        ) {
            let lens = Distortion { k1: -0.1, k2: 0.02, p1: 1e-3, ..Distortion::NONE }.into();
            let intrinsics = Intrinsics { lens, ..Intrinsics::pinhole(320, 240, 250.0) };
            let camera = Camera::look_at("wide", intrinsics, DVec3::ZERO, DVec3::Z, DVec3::Y).unwrap();
            let (middle, radius) = (DVec2::new(disc.0, disc.1), disc.2);
            let mask = Mask::from_fn(320, 240, |x, y| {
                DVec2::new(f64::from(x), f64::from(y)).distance(middle) < radius
            });
            let ahead = DVec2::from_array(ahead).extend(1.0);
            let window = camera.turned(ahead, DVec3::X, Intrinsics::pinhole(90, 70, focal)).unwrap();
            let to_mask = PixelMap::between(&window, &camera);
            let (mut fast, mut every) = (Mask::new(90, 70), Mask::new(90, 70));
            resample(&mask, &to_mask, &mut fast);
            slow(&mask, &to_mask, &mut every);
            prop_assert!(fast == every);
        }
    }
}
