//! The ordered outer contour of a mask.

use crate::mask::Mask;

/// The outer boundary of a silhouette, in order.
///
/// The points are the centres (integer + 0.5) of the hand's boundary pixels: those with a
/// background pixel of the image above, below, left or right of them. Neighbours in the order are
/// neighbours in the grid, straight or diagonal, and the hand lies to the right of the way, which
/// on screen is clockwise. A part that is one pixel wide is walked up one side and down the other,
/// so that its pixels appear twice.
///
/// The image border cuts the contour, and the cut is no contour: a silhouette that leaves the
/// image gives open pieces from border to border. Holes have no contour here.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contour {
    /// `[x, y]` of the points, in pixels, piece after piece.
    pub points: Vec<[f64; 2]>,
    /// For each piece the index after its last point.
    ends: Vec<usize>,
    closed: bool,
}

impl Contour {
    /// Whether the contour is one closed curve: the silhouette touches no image border.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The connected pieces, each a slice of [`Contour::points`]. A closed contour is one piece,
    /// whose last point neighbours its first.
    pub fn pieces(&self) -> impl ExactSizeIterator<Item = &[[f64; 2]]> {
        let piece = |i: usize| {
            let start = if i == 0 { 0 } else { self.ends[i - 1] };
            &self.points[start..self.ends[i]]
        };
        (0..self.ends.len()).map(piece)
    }

    /// The contour of the component to which the first hand pixel in reading order belongs. Empty
    /// where there is no hand, or no background outside it.
    ///
    /// ```
    /// use phalanx_segmentation::{Contour, Mask};
    ///
    /// let mask = Mask::from_fn(40, 30, |x, y| {
    ///     (15..25).contains(&x) && y >= 10
    /// });
    /// let contour = Contour::trace(&mask); // up one side, along the top, and down the other
    /// assert!(!contour.is_closed());
    /// assert_eq!(contour.pieces().len(), 1);
    /// assert_eq!(contour.points.len(), 20 + 8 + 20);
    /// ```
    pub fn trace(mask: &Mask) -> Self {
        let mut contour = Self::default();
        contour.trace_again(mask);
        contour
    }

    /// [`Contour::trace`] in this contour's memory.
    pub(crate) fn trace_again(&mut self, mask: &Mask) {
        self.points.clear();
        self.ends.clear();
        self.closed = false;
        let Some(start) = Crack::first(mask).and_then(|first| first.start_of_piece(mask)) else {
            return;
        };
        self.closed = true;
        let mut piece = 0;
        let mut crack = start;
        loop {
            if crack.is_cut(mask) {
                self.closed = false;
                self.end_piece(piece);
            } else {
                piece = self.ends.last().copied().unwrap_or(0);
                let centre = crack.pixel.map(|v| v as f64 + 0.5);
                if self.points.len() == piece || self.points.last() != Some(&centre) {
                    self.points.push(centre);
                }
            }
            crack = crack.next(mask);
            if crack == start {
                break;
            }
        }
        if self.closed && self.points.len() > 1 && self.points.first() == self.points.last() {
            self.points.pop();
        }
        self.end_piece(piece);
    }

    fn end_piece(&mut self, start: usize) {
        if self.points.len() > start && self.ends.last() != Some(&self.points.len()) {
            self.ends.push(self.points.len());
        }
    }
}

/// The edge between a hand pixel and what lies outside the hand, walked with the hand on the right.
///
/// Following cracks rather than pixels tells the two sides of a pixel apart: one may be contour and
/// the other a cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Crack {
    pixel: [i64; 2],
    /// 0 to 3: walking right above the pixel, down beside it, left below it, up beside it.
    heading: usize,
}

const STEPS: [[i64; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

fn is_inside(mask: &Mask, [x, y]: [i64; 2]) -> bool {
    (0..i64::from(mask.width())).contains(&x) && (0..i64::from(mask.height())).contains(&y)
}

fn is_hand(mask: &Mask, pixel: [i64; 2]) -> bool {
    is_inside(mask, pixel) && mask.is_hand(pixel[0] as u32, pixel[1] as u32)
}

fn step([x, y]: [i64; 2], heading: usize) -> [i64; 2] {
    let [dx, dy] = STEPS[heading % 4];
    [x + dx, y + dy]
}

impl Crack {
    /// Above the first hand pixel in reading order, so certainly on an outer boundary.
    fn first(mask: &Mask) -> Option<Self> {
        let index = mask.iter().position(|&level| Mask::is_hand_level(level))? as i64;
        let width = i64::from(mask.width());
        Some(Self { pixel: [index % width, index / width], heading: 0 })
    }

    /// The next crack of the same boundary. Pixels that meet at a corner are connected.
    fn next(self, mask: &Mask) -> Self {
        let Self { pixel, heading } = self;
        let ahead = step(pixel, heading);
        let outer = step(ahead, heading + 3);
        if is_hand(mask, outer) {
            Self { pixel: outer, heading: (heading + 3) % 4 }
        } else if is_hand(mask, ahead) {
            Self { pixel: ahead, heading }
        } else {
            Self { pixel, heading: (heading + 1) % 4 }
        }
    }

    /// Whether the image ends here.
    fn is_cut(self, mask: &Mask) -> bool {
        !is_inside(mask, step(self.pixel, self.heading + 3))
    }

    /// From here on the first crack that follows a cut; without any cut, here; without anything
    /// but cuts, nothing.
    fn start_of_piece(self, mask: &Mask) -> Option<Self> {
        let mut crack = self;
        loop {
            let next = crack.next(mask);
            if crack.is_cut(mask) && !next.is_cut(mask) {
                return Some(next);
            }
            if next == self {
                return (!crack.is_cut(mask)).then_some(self);
            }
            crack = next;
        }
    }
}
