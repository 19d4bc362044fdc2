//! A mask as another camera at the same place sees it.

use glam::DVec2;
use phalanx_camera::PixelMap;
use phalanx_segmentation::Mask;

/// Samples along a row between places where the map is evaluated; it is straight in between, to far
/// less than a pixel.
const STRETCH: u32 = 8;

/// The most samples along a side of a window's pixel.
const MOST_SAMPLES: u32 = 4;

/// Fills `seen` with the mask under a map from its pixels to the mask's: 255 where the mask covers at
/// least half of a pixel. There is nothing outside the mask.
pub(crate) fn resample(mask: &Mask, to_mask: &PixelMap, seen: &mut Mask) {
    let (width, height) = seen.dimensions();
    let samples = samples_aside(to_mask, (width, height));
    let mut row = Vec::with_capacity((width * samples) as usize);
    let mut sums = vec![0.0; width as usize];
    for y in 0..height {
        sums.fill(0.0);
        for k in 0..samples {
            let y = f64::from(y) + (f64::from(k) + 0.5) / f64::from(samples);
            positions(to_mask, y, width * samples, f64::from(samples), &mut row);
            for (sum, positions) in sums.iter_mut().zip(row.chunks_exact(samples as usize)) {
                *sum += positions.iter().map(|&position| level(mask, position)).sum::<f64>();
            }
        }
        let half = 0.5 * f64::from(samples * samples);
        for (x, &sum) in sums.iter().enumerate() {
            seen.get_pixel_mut(x as u32, y).0[0] = if sum >= half { 255 } else { 0 };
        }
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
        positions(to_picture, y as f64 + 0.5, width, 1.0, &mut row);
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
        positions(to_picture, y as f64 + 0.5, width, 1.0, &mut row);
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

/// Where `count` samples of a row, so many to the pixel, lie in the mask; NaN where nowhere.
fn positions(to_mask: &PixelMap, y: f64, count: u32, per_pixel: f64, row: &mut Vec<DVec2>) {
    let at = |sample: u32| {
        let x = (f64::from(sample) + 0.5) / per_pixel;
        to_mask.map(DVec2::new(x, y)).unwrap_or(DVec2::NAN)
    };
    row.clear();
    let mut from = at(0);
    for first in (0..count).step_by(STRETCH as usize) {
        let to = at(first + STRETCH);
        let step = (to - from) / f64::from(STRETCH);
        let ahead = STRETCH.min(count - first);
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
    let first = corner.floor();
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
