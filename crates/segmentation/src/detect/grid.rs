//! One component of a mask on a grid that is coarse enough to be walked quickly.

use crate::mask::components::Span;

/// Cells of background around the component, so that no step leaves the grid.
const MARGIN: usize = 2;

/// The longest side of a grid, in cells, without its margin.
const LONGEST: usize = 200;

/// One component, each cell of it `scale` pixels wide and high.
#[derive(Debug, Clone, Default)]
pub(crate) struct Grid {
    pub(crate) width: usize,
    pub(crate) scale: usize,
    /// The pixel position of the first cell's corner.
    corner: [f64; 2],
    /// Pixels of the component in each cell.
    counts: Vec<u32>,
    pub(crate) inside: Vec<bool>,
    /// Cells of the component with pixels of the image's border, in order along it.
    pub(crate) at_border: Vec<bool>,
}

impl Grid {
    /// Takes the spans of a component of an image of this width and height, in pixels.
    pub(crate) fn fill(&mut self, spans: &[Span], (width, height): (usize, usize)) {
        let least = |side: fn(&Span) -> usize| spans.iter().map(side).min().unwrap_or(0);
        let most = |side: fn(&Span) -> usize| spans.iter().map(side).max().unwrap_or(0);
        let (left, right) = (least(|span| span.start), most(|span| span.end));
        let (top, bottom) = (least(|span| span.row), most(|span| span.row) + 1);
        self.scale = (right - left).max(bottom - top).div_ceil(LONGEST).max(1);
        let cells = |length: usize| length.div_ceil(self.scale) + 2 * MARGIN;
        let corner = |first: usize| first as f64 - (MARGIN * self.scale) as f64;
        self.width = cells(right - left);
        self.corner = [corner(left), corner(top)];
        let size = self.width * cells(bottom - top);
        for flags in [&mut self.inside, &mut self.at_border] {
            flags.clear();
            flags.resize(size, false);
        }
        self.counts.clear();
        self.counts.resize(size, 0);
        for span in spans {
            let row = (MARGIN + (span.row - top) / self.scale) * self.width + MARGIN;
            let at_edge = span.row == 0 || span.row + 1 == height;
            for x in span.start..span.end {
                let cell = row + (x - left) / self.scale;
                self.counts[cell] += 1;
                self.at_border[cell] |= at_edge || x == 0 || x + 1 == width;
            }
        }
        let half = (self.scale * self.scale).div_ceil(2) as u32;
        for ((inside, border), &count) in
            self.inside.iter_mut().zip(&mut self.at_border).zip(&self.counts)
        {
            *inside = count >= half || (*border && count > 0);
            *border &= *inside;
        }
    }

    /// The component's cells.
    pub(crate) fn cells(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.inside.len()).filter(|&cell| self.inside[cell])
    }

    /// The component's pixels in a cell.
    pub(crate) fn area(&self, cell: usize) -> f64 {
        f64::from(self.counts[cell])
    }

    /// The middle of a cell, in pixels of the image.
    pub(crate) fn position(&self, cell: usize) -> [f64; 2] {
        let at = |k: usize, corner: f64| corner + (k as f64 + 0.5) * self.scale as f64;
        [at(cell % self.width, self.corner[0]), at(cell / self.width, self.corner[1])]
    }

    /// The component's cell nearest to a position in the image, in pixels.
    pub(crate) fn nearest(&self, [x, y]: [f64; 2]) -> Option<usize> {
        let distance = |cell: usize| {
            let [cx, cy] = self.position(cell);
            (cx - x).powi(2) + (cy - y).powi(2)
        };
        self.cells().min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
    }

    /// The 8 neighbours of a cell.
    pub(crate) fn around(&self, cell: usize) -> [usize; 8] {
        let (up, down) = (cell - self.width, cell + self.width);
        [up - 1, up, up + 1, cell - 1, cell + 1, down - 1, down, down + 1]
    }

    /// The component's connected stretches along the image border.
    pub(crate) fn crossings(&self) -> Vec<Vec<usize>> {
        let mut left = self.at_border.clone();
        let mut crossings = Vec::new();
        for first in 0..left.len() {
            if !std::mem::take(&mut left[first]) {
                continue;
            }
            let mut crossing = vec![first];
            let mut next = 0;
            while let Some(&cell) = crossing.get(next) {
                crossing.extend(
                    self.around(cell).into_iter().filter(|&near| std::mem::take(&mut left[near])),
                );
                next += 1;
            }
            crossings.push(crossing);
        }
        crossings
    }
}
