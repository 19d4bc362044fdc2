//! Where in the picture the hand is, coarsely.

use phalanx_segmentation::Mask;
/// Cells of the grid, across and down: five pixels wide and high at
/// [`WORKING_SIZE`](crate::WORKING_SIZE).
const CELLS: (u32, u32) = (24, 18);
/// Numbers of a view's grid.
pub(crate) const OCCUPANCY: usize = (CELLS.0 * CELLS.1) as usize;

/// The part of each cell of a grid that is hand, 0 to 1, row by row.
///
/// # Panics
/// If `out` is not [`OCCUPANCY`] long.
pub(crate) fn occupancy_into(mask: &Mask, out: &mut [f64]) {
    assert_eq!(out.len(), OCCUPANCY, "one number for each cell");
    let (width, height) = mask.dimensions();
    let edge = |cell: u32, cells: u32, length: u32| (cell * length / cells) as usize;
    for (row, cells) in out.chunks_exact_mut(CELLS.0 as usize).enumerate() {
        let row = row as u32;
        let (top, bottom) = (edge(row, CELLS.1, height), edge(row + 1, CELLS.1, height));
        for (column, cell) in (0..).zip(cells) {
            let (left, right) = (edge(column, CELLS.0, width), edge(column + 1, CELLS.0, width));
            let line = |y: usize| &mask.as_raw()[y * width as usize..][left..right];
            let hand: usize = (top..bottom)
                .map(|y| line(y).iter().filter(|&&level| Mask::is_hand_level(level)).count())
                .sum();
            let pixels = (bottom - top) * (right - left);
            *cell = hand as f64 / pixels.max(1) as f64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_tells_its_share() {
        let hand = |x: u32, y: u32| x < 60 && (y < 45 || x.is_multiple_of(5));
        let mask = Mask::from_fn(120, 90, hand);
        let mut cells = vec![f64::NAN; OCCUPANCY];
        occupancy_into(&mask, &mut cells);
        for (place, cell) in cells.into_iter().enumerate() {
            let (row, column) = (place / 24, place % 24);
            let expected = match (row < 9, column < 12) {
                (true, true) => 1.0,
                (false, true) => 0.2,
                (_, false) => 0.0,
            };
            assert_eq!(cell, expected, "cell {column}, {row}");
        }
    }

    #[test]
    fn any_size_has_as_many_cells() {
        for (width, height) in [(16, 16), (640, 480), (121, 91)] {
            let mask = Mask::from_fn(width, height, |_, _| true);
            let mut cells = vec![f64::NAN; OCCUPANCY];
            occupancy_into(&mask, &mut cells);
            assert!(cells.iter().all(|cell| *cell == 0.0 || *cell == 1.0));
        }
    }
}
