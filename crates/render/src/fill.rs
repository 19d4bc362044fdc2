//! Filling polygons by pixel centres.

use std::ops::Range;

use glam::DVec2;

/// Fills simple polygons by the edge-flag method (Ackland and Weste, 1981, *The edge flag
/// algorithm: a fill method for raster scan displays*): each edge flips, in every row that it
/// crosses, all pixels to its right; what is flipped an odd number of times is inside.
#[derive(Debug, Clone)]
pub(crate) struct Filler {
    width: usize,
    height: usize,
    /// 255 where a pixel and all to its right flip; all zero between calls.
    flips: Vec<u8>,
}

/// The part of the raster that a polygon's edges cross.
struct Window {
    rows: Range<usize>,
    columns: Range<usize>,
}

impl Filler {
    pub(crate) fn new(width: u32, height: u32) -> Self {
        let (width, height) = (width as usize, height as usize);
        Self { width, height, flips: vec![0; width * height] }
    }

    /// Sets to 255 every pixel of the row-major `mask` whose sample lies in the polygon, where
    /// `sample` is its offset from the pixel's upper left corner. A sample on the left or
    /// upper edge is inside, on the right or lower edge outside.
    pub(crate) fn fill(&mut self, polygon: &[DVec2], sample: DVec2, mask: &mut [u8]) {
        let mut window = Window { rows: self.height..0, columns: self.width..0 };
        let Some(last) = polygon.last() else { return };
        let mut from = *last - sample;
        for corner in polygon {
            let to = *corner - sample;
            self.flip_right_of(from, to, &mut window);
            from = to;
        }
        self.sweep(&window, mask);
    }

    /// Marks where an edge crosses the rows, and widens the window to hold the marks.
    fn flip_right_of(&mut self, from: DVec2, to: DVec2, window: &mut Window) {
        let (upper, lower) = if from.y < to.y { (from, to) } else { (to, from) };
        let rows = index_from(upper.y)..self.height.min(index_from(lower.y));
        if rows.is_empty() {
            return;
        }
        window.rows = window.rows.start.min(rows.start)..window.rows.end.max(rows.end);
        let slope = (lower.x - upper.x) / (lower.y - upper.y);
        for row in rows {
            let x = upper.x + (row as f64 - upper.y) * slope;
            let column = index_from(x);
            window.columns.end = window.columns.end.max(self.width.min(column.saturating_add(1)));
            if column < self.width {
                window.columns.start = window.columns.start.min(column);
                self.flips[row * self.width + column] ^= 255;
            }
        }
    }

    /// Runs along the rows of the window, paints what is inside and clears the marks.
    fn sweep(&mut self, window: &Window, mask: &mut [u8]) {
        if window.columns.is_empty() {
            return;
        }
        for row in window.rows.clone() {
            let start = row * self.width;
            let span = start + window.columns.start..start + window.columns.end;
            sweep_row(&mut self.flips[span.clone()], &mut mask[span]);
        }
    }
}

/// Paints what is inside of a row and clears its marks.
fn sweep_row(flips: &mut [u8], pixels: &mut [u8]) {
    let (flips, last_flips) = flips.as_chunks_mut::<8>();
    let (pixels, last_pixels) = pixels.as_chunks_mut::<8>();
    let mut inside = 0;
    for (flips, pixels) in flips.iter_mut().zip(pixels) {
        // Each byte becomes the flips of all bytes up to it.
        let mut painted = u64::from_le_bytes(std::mem::take(flips));
        painted ^= painted << 8;
        painted ^= painted << 16;
        painted ^= painted << 32;
        painted ^= inside;
        inside = if painted >> 63 == 1 { u64::MAX } else { 0 };
        *pixels = (u64::from_le_bytes(*pixels) | painted).to_le_bytes();
    }
    let mut inside = inside as u8;
    for (flip, pixel) in last_flips.iter_mut().zip(last_pixels) {
        inside ^= std::mem::take(flip);
        *pixel |= inside;
    }
}

/// The first index at or after `x`: its ceiling, without a call to the mathematics library.
fn index_from(x: f64) -> usize {
    // The cast rounds down, and clamps what is negative to 0; 32 bits are cast back faster.
    let below = x as u32;
    below.saturating_add(u32::from(f64::from(below) < x)) as usize
}
