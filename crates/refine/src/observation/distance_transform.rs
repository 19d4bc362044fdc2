//! The nearest place of a boundary to every pixel.

use glam::DVec2;

use crate::observation::boundary::beside;

/// The nearest edge of every pixel, by two sweeps that hand on neighbours' (Danielsson 1980): in
/// rare places the second nearest.
pub(crate) fn nearest_edges(edges: &[DVec2], (width, height): (u32, u32)) -> Vec<u32> {
    let (w, h) = (width as usize, height as usize);
    let mut nearest = Nearest {
        edges,
        of_pixels: vec![u32::MAX; w * h],
        squared: vec![f64::INFINITY; w * h],
        width: w,
    };
    for (index, edge) in edges.iter().enumerate() {
        for [x, y] in beside(*edge) {
            nearest.offer(x as usize, y as usize, index as u32);
        }
    }
    for y in 0..h {
        for x in 0..w {
            if y > 0 {
                nearest.take_row(x, y, y - 1);
            }
            if x > 0 {
                nearest.take(x, y, x - 1, y);
            }
        }
        (0..w - 1).rev().for_each(|x| nearest.take(x, y, x + 1, y));
    }
    for y in (0..h - 1).rev() {
        for x in (0..w).rev() {
            nearest.take_row(x, y, y + 1);
            if x + 1 < w {
                nearest.take(x, y, x + 1, y);
            }
        }
        (1..w).for_each(|x| nearest.take(x, y, x - 1, y));
    }
    nearest.of_pixels
}

/// The nearest edge of every pixel so far.
struct Nearest<'a> {
    edges: &'a [DVec2],
    of_pixels: Vec<u32>,
    /// How far it is from the pixel's middle, squared.
    squared: Vec<f64>,
    width: usize,
}

impl Nearest<'_> {
    /// An edge that may be nearer to a pixel.
    fn offer(&mut self, x: usize, y: usize, edge: u32) {
        let Some(at) = self.edges.get(edge as usize) else { return };
        let pixel = y * self.width + x;
        let squared = at.distance_squared(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        if squared < self.squared[pixel] {
            (self.of_pixels[pixel], self.squared[pixel]) = (edge, squared);
        }
    }

    /// That of another pixel.
    fn take(&mut self, x: usize, y: usize, from_x: usize, from_y: usize) {
        let edge = self.of_pixels[from_y * self.width + from_x];
        if edge != self.of_pixels[y * self.width + x] {
            self.offer(x, y, edge);
        }
    }

    /// Those of the three nearest pixels of another row.
    fn take_row(&mut self, x: usize, y: usize, from_y: usize) {
        for from_x in x.saturating_sub(1)..self.width.min(x + 2) {
            self.take(x, y, from_x, from_y);
        }
    }
}
