//! The nearest place of a boundary to every pixel.

use glam::DVec2;

use crate::observation::boundary::beside;

/// The nearest edge of every pixel, by two sweeps that hand on neighbours' (Danielsson 1980): in
/// rare places the second nearest.
pub(crate) fn nearest_edges(edges: &[DVec2], (width, height): (u32, u32)) -> Vec<u32> {
    let (w, h) = (width as usize, height as usize);
    let doubled = |edge: &DVec2| [(2.0 * edge.x) as i32, (2.0 * edge.y) as i32];
    let mut nearest = Nearest {
        edges: edges.iter().map(doubled).collect(),
        of_pixels: vec![NONE; w * h],
        squared: vec![u32::MAX; w * h],
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

/// Of a pixel that no edge was offered to yet.
const NONE: u32 = u32::MAX;

/// The nearest edge of every pixel so far.
struct Nearest {
    /// In half pixels, which are integers for edges as for the middles of pixels.
    edges: Vec<[i32; 2]>,
    of_pixels: Vec<u32>,
    /// How far it is from the pixel's middle, half pixels squared.
    squared: Vec<u32>,
    width: usize,
}

impl Nearest {
    /// An edge that may be nearer to a pixel.
    fn offer(&mut self, x: usize, y: usize, edge: u32) {
        let at = self.edges[edge as usize];
        let pixel = y * self.width + x;
        let [dx, dy] = [at[0] - (2 * x as i32 + 1), at[1] - (2 * y as i32 + 1)];
        let squared = (dx * dx + dy * dy) as u32;
        if squared < self.squared[pixel] {
            (self.of_pixels[pixel], self.squared[pixel]) = (edge, squared);
        }
    }

    /// That of another pixel.
    fn take(&mut self, x: usize, y: usize, from_x: usize, from_y: usize) {
        let edge = self.of_pixels[from_y * self.width + from_x];
        if edge != self.of_pixels[y * self.width + x] && edge != NONE {
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
