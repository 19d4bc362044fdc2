//! A mask as another camera at the same place sees it.

use std::ops::Range;

use glam::DVec2;
use phalanx_camera::PixelMap;
use phalanx_segmentation::Mask;

/// Samples along a row between places where the map is evaluated; it is straight in between, to far less than a pixel.
const STRETCH: u32 = 8;

/// Side of the blocks of pixels that are looked at together first; as wide as a stretch or several, however many
/// samples there are to a pixel.
const BLOCK: u32 = STRETCH;

/// Side of the pieces of a block whose pixels are sampled one by one where the mask around them is not all alike.
const PIECE: u32 = 2;

/// The most samples along a side of a window's pixel.
const MOST_SAMPLES: u32 = 4;

/// How far around a block its samples may tell of, px of the mask: half a pixel by nearness, and the rest for what a
/// lens bends within a block.
const AROUND: f64 = 2.0;

/// Where the pixels of a window lie in a picture.
#[derive(Debug, Clone)]
pub(crate) struct PixelPlaces {
    to_picture: PixelMap,
    /// The window's size, px.
    size: (u32, u32),
    /// The places of the blocks' corners, row by row; NaN where the map leads nowhere.
    corners: Vec<DVec2>,
    /// How many of the picture's pixels a pixel in the middle of the window covers along a side.
    aside: f64,
}

/// The places of a block's corners: above left and right, then below.
#[derive(Clone, Copy)]
struct Block([DVec2; 4]);

impl PixelPlaces {
    /// Of a window of some size under a map from its pixels to the picture's.
    pub(crate) fn new(to_picture: &PixelMap, size: (u32, u32)) -> Self {
        let [across, down] = [size.0, size.1].map(|side| side.div_ceil(BLOCK));
        let corner = |at: u32| f64::from(BLOCK * at);
        let place = |x, y| to_picture.map(DVec2::new(x, y)).unwrap_or(DVec2::NAN);
        let row = |y| (0..=across).map(move |x| place(corner(x), corner(y)));
        let corners = (0..=down).flat_map(row).collect();
        Self { to_picture: *to_picture, size, corners, aside: pixels_aside(to_picture, size) }
    }

    /// How many of the picture's pixels a pixel in the middle of the window covers along a side.
    pub(crate) fn pixels_aside(&self) -> f64 {
        self.aside
    }

    /// Fills `seen`, of the window's size, with a mask of the picture's: 255 where the mask covers at least half of a
    /// pixel. There is nothing outside the mask.
    pub(crate) fn resample(&self, mask: &Mask, seen: &mut Mask) {
        for (first, block) in self.blocks() {
            let mut open = 0;
            let mut pieces = Vec::from([[0, 0, BLOCK]]);
            while let Some([x, y, side]) = pieces.pop() {
                // Most pieces are all hand or all background.
                if let Some(level) = alike_around(mask, block.piece([x, y], side)) {
                    self.fill(seen, [first[0] + x, first[1] + y], side, level);
                } else if side > PIECE {
                    let half = side / 2;
                    let halves = [[x, y], [x + half, y], [x, y + half], [x + half, y + half]];
                    pieces.extend(halves.map(|[x, y]| [x, y, half]));
                } else {
                    open |= bits_of([x, y], side);
                }
            }
            self.sample(mask, first, open, seen);
        }
    }

    /// Which pixels of the window lie in a picture of some size, wholly and with a neighbour: 255, all others 0.
    pub(crate) fn inside(&self, picture: (u32, u32)) -> Mask {
        let least = DVec2::splat(1.5 * self.aside);
        let most = DVec2::new(f64::from(picture.0), f64::from(picture.1)) - least;
        let mut inside = Mask::new(self.size.0, self.size.1);
        self.each_pixel([least, most], &mut inside, |is_inside, pixel| {
            *pixel = 255 * u8::from(is_inside);
        });
        inside
    }

    /// Leaves nothing of a mask of the window's size outside a picture of some size.
    pub(super) fn cut(&self, mask: &mut Mask, picture: (u32, u32)) {
        let most = DVec2::new(f64::from(picture.0), f64::from(picture.1));
        self.each_pixel([DVec2::ZERO, most], mask, |is_inside, pixel| {
            *pixel *= u8::from(is_inside);
        });
    }

    /// Sets each pixel of a window by whether its middle lies in a rectangle of the picture.
    fn each_pixel(&self, [low, high]: [DVec2; 2], window: &mut Mask, set: impl Fn(bool, &mut u8)) {
        // A NaN is not inside.
        let is_inside = |at: &DVec2| at.cmpge(low).all() && at.cmple(high).all();
        let [low_within, high_within] = [low + AROUND, high - AROUND];
        let is_within = |at: &DVec2| at.cmpge(low_within).all() && at.cmple(high_within).all();
        let mut row = Vec::with_capacity(BLOCK as usize);
        for ([left, top], block) in self.blocks() {
            let is_all_inside = block.0.iter().all(is_within);
            for y in top..self.size.1.min(top + BLOCK) {
                let line = self.line(window, [left, y], BLOCK);
                if is_all_inside {
                    for pixel in line {
                        set(true, pixel);
                    }
                    continue;
                }
                let columns = left..left + line.len() as u32;
                positions(&self.to_picture, f64::from(y) + 0.5, columns, 1.0, &mut row);
                line.iter_mut().zip(&row).for_each(|(pixel, at)| set(is_inside(at), pixel));
            }
        }
    }

    /// Samples those pixels of a block that are still open.
    fn sample(&self, mask: &Mask, [left, top]: [u32; 2], open: u64, seen: &mut Mask) {
        let samples = self.samples_aside();
        let half = 0.5 * f64::from(samples * samples);
        let mut row = Vec::with_capacity((BLOCK * samples) as usize);
        for y in top..self.size.1.min(top + BLOCK) {
            let open = open >> (BLOCK * (y - top)) & ((1 << BLOCK) - 1);
            if open == 0 {
                continue;
            }
            let line = self.line(seen, [left, y], BLOCK);
            let mut sums = [0.0; BLOCK as usize];
            let columns = samples * left..samples * (left + line.len() as u32);
            for k in 0..samples {
                let y = f64::from(y) + (f64::from(k) + 0.5) / f64::from(samples);
                positions(&self.to_picture, y, columns.clone(), f64::from(samples), &mut row);
                let pixels = row.chunks_exact(samples as usize).zip(&mut sums).enumerate();
                for (_, (places, sum)) in pixels.filter(|(x, _)| open >> x & 1 != 0) {
                    *sum += places.iter().map(|&place| level(mask, place)).sum::<f64>();
                }
            }
            let pixels = line.iter_mut().zip(sums).enumerate();
            for (_, (pixel, sum)) in pixels.filter(|(x, _)| open >> x & 1 != 0) {
                *pixel = if sum >= half { 255 } else { 0 };
            }
        }
    }

    /// Samples along a side of a pixel: as many as it covers of the mask's pixels.
    fn samples_aside(&self) -> u32 {
        (self.aside.ceil() as u32).clamp(1, MOST_SAMPLES)
    }

    /// The blocks, each with its first pixel.
    fn blocks(&self) -> impl Iterator<Item = ([u32; 2], Block)> {
        let [across, down] = [self.size.0, self.size.1].map(|side| side.div_ceil(BLOCK));
        let stride = across as usize + 1;
        (0..down).flat_map(move |y| {
            (0..across).map(move |x| {
                let first = y as usize * stride + x as usize;
                let places = [0, 1, stride, stride + 1].map(|next| self.corners[first + next]);
                ([BLOCK * x, BLOCK * y], Block(places))
            })
        })
    }

    /// Gives a square of a window's pixels a level, as far as that reaches.
    fn fill(&self, window: &mut Mask, [left, top]: [u32; 2], side: u32, level: u8) {
        for y in top..self.size.1.min(top + side) {
            self.line(window, [left, y], side).fill(level);
        }
    }

    /// So many pixels of a row from one on, as far as that reaches.
    fn line<'a>(&self, window: &'a mut Mask, [left, y]: [u32; 2], side: u32) -> &'a mut [u8] {
        let width = self.size.0;
        let pixels: &mut [u8] = window;
        let last = width.min(left + side).max(left);
        &mut pixels[(y * width) as usize..][..width as usize]
            [left.min(width) as usize..last.min(width) as usize]
    }
}

impl Block {
    /// The place so many pixels along and down.
    fn at(&self, [x, y]: [u32; 2]) -> DVec2 {
        let Self([above_left, above_right, below_left, below_right]) = *self;
        let [x, y] = [x, y].map(|pixels| f64::from(pixels) / f64::from(BLOCK));
        let left = above_left + (below_left - above_left) * y;
        let right = above_right + (below_right - above_right) * y;
        left + (right - left) * x
    }

    /// The places of the corners of a square of pixels.
    fn piece(&self, [x, y]: [u32; 2], side: u32) -> [DVec2; 4] {
        [[x, y], [x + side, y], [x, y + side], [x + side, y + side]].map(|corner| self.at(corner))
    }
}

/// A bit for each pixel of a square in a block, row by row.
fn bits_of([x, y]: [u32; 2], side: u32) -> u64 {
    let row = ((1 << side) - 1) << x;
    (y..y + side).map(|y| row << (BLOCK * y)).fold(0, |all, row| all | row)
}

/// The one level of the mask, 0 or 255, in the rectangle around four places and somewhat further; `None` where it
/// has both, or a place is nowhere.
fn alike_around(mask: &Mask, places: [DVec2; 4]) -> Option<u8> {
    if places.iter().any(|place| place.is_nan()) {
        return None;
    }
    let [a, b, c, d] = places;
    let (low, high) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
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

/// How many of the mask's pixels a pixel in the middle of a window of some size covers along a side.
pub(super) fn pixels_aside(to_mask: &PixelMap, (width, height): (u32, u32)) -> f64 {
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
    fn slow(mask: &Mask, places: &PixelPlaces, seen: &mut Mask) {
        for (first, _) in places.blocks() {
            places.sample(mask, first, u64::MAX, seen);
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
            let places = PixelPlaces::new(&to_mask, (90, 70));
            let (mut fast, mut every) = (Mask::new(90, 70), Mask::new(90, 70));
            places.resample(&mask, &mut fast);
            slow(&mask, &places, &mut every);
            prop_assert!(fast == every);
        }
    }
}
