//! The nearest place of a boundary to every pixel.

use glam::DVec2;

use crate::observation::boundary::beside;

/// The nearest edge of every pixel, by two sweeps that hand on neighbours' (Danielsson 1980): in
/// rare places the second nearest.
pub(crate) fn nearest_edges(edges: &[DVec2], (width, height): (u32, u32)) -> Vec<u32> {
    let (w, h) = (width as usize, height as usize);
    let mut pixels = vec![Nearest { edge: NONE, squared: u32::MAX }; w * h];
    let places: Vec<[i32; 2]> =
        edges.iter().map(|edge| [(2.0 * edge.x) as i32, (2.0 * edge.y) as i32]).collect();
    for (index, edge) in edges.iter().enumerate() {
        for [x, y] in beside(*edge) {
            pixels[y as usize * w + x as usize].offer(index as u32, [x, y].map(middle), &places);
        }
    }
    let mut above: &[Nearest] = &[];
    for (y, row) in pixels.chunks_exact_mut(w).enumerate() {
        hand_on(above, row, (0..w).map(|x| (x, y)), &places);
        hand_on(&[], row, (0..w).rev().map(|x| (x, y)), &places);
        above = row;
    }
    let mut rows = pixels.chunks_exact_mut(w).enumerate().rev();
    let mut below: &[Nearest] = rows.next().map_or(&[], |(_, last)| last);
    for (y, row) in rows {
        hand_on(below, row, (0..w).rev().map(|x| (x, y)), &places);
        hand_on(&[], row, (0..w).map(|x| (x, y)), &places);
        below = row;
    }
    pixels.into_iter().map(|nearest| nearest.edge).collect()
}

/// Of a pixel that no edge was offered to yet.
const NONE: u32 = u32::MAX;

/// The nearest edge of a pixel so far.
#[derive(Clone, Copy)]
struct Nearest {
    edge: u32,
    /// How far it is from the pixel's middle, half pixels squared.
    squared: u32,
}

impl Nearest {
    /// An edge that may be nearer to a pixel with its middle at a place, in half pixels, which are integers for edges as for
    /// the middles of pixels.
    fn offer(&mut self, edge: u32, [x, y]: [i32; 2], places: &[[i32; 2]]) {
        if edge == self.edge || edge == NONE {
            return;
        }
        let at = places[edge as usize];
        let [dx, dy] = [at[0] - x, at[1] - y];
        let squared = (dx * dx + dy * dy) as u32;
        if squared < self.squared {
            *self = Self { edge, squared };
        }
    }
}

/// The middle of a pixel, half pixels.
fn middle(at: u32) -> i32 {
    2 * at as i32 + 1
}

/// Offers each pixel of a row, in some order, those of the three nearest of another row, if there is one, and that of the
/// pixel before it.
fn hand_on(
    other: &[Nearest],
    row: &mut [Nearest],
    order: impl Iterator<Item = (usize, usize)>,
    places: &[[i32; 2]],
) {
    let mut before = NONE;
    for (x, y) in order {
        let mut own = row[x];
        let at = [x, y].map(|at| middle(at as u32));
        let near = x.saturating_sub(1)..(x + 2).min(other.len());
        for nearest in other.get(near).unwrap_or(&[]) {
            own.offer(nearest.edge, at, places);
        }
        own.offer(before, at, places);
        before = own.edge;
        row[x] = own;
    }
}
