//! The majority vote of a square window: a median filter for masks.

use crate::mask::Mask;

/// Counts and sums of one row of windows, used again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Majority {
    /// Hand pixels in each column of the window's rows, with `radius` zeros at either end.
    columns: Vec<u8>,
    /// Hand pixels in each window.
    votes: Vec<u8>,
}

impl Majority {
    /// Each pixel of `out` becomes 255 where more than half of the window around it, cut to the
    /// image, is over 127, and 0 where less than half is; on a draw the pixel stays as it is.
    pub(crate) fn vote(&mut self, pixels: &[u8], width: usize, radius: usize, out: &mut [u8]) {
        let height = pixels.len() / width;
        for y in 0..height {
            let rows = y.saturating_sub(radius)..(y + radius + 1).min(height);
            let voters_down = rows.len();
            self.count(&pixels[rows.start * width..rows.end * width], width, radius);
            let here = &pixels[y * width..][..width];
            let out = &mut out[y * width..][..width];
            // All windows between the ends are equally wide.
            let left = radius.min(width);
            let right = width.saturating_sub(radius).max(left);
            let ends = (0..left).chain(right..width).map(|x| x..x + 1);
            let middle = (left < right).then_some(left..right);
            for columns in ends.chain(middle) {
                let x = columns.start;
                let voters_across = (x + radius + 1).min(width) - x.saturating_sub(radius);
                let voters = (voters_down * voters_across) as u16;
                let votes = &self.votes[columns.clone()];
                settle(&here[columns.clone()], votes, voters, &mut out[columns]);
            }
        }
    }

    fn count(&mut self, rows: &[u8], width: usize, radius: usize) {
        self.columns.clear();
        self.columns.resize(width + 2 * radius, 0);
        for row in rows.chunks_exact(width) {
            for (sum, &level) in self.columns[radius..].iter_mut().zip(row) {
                *sum += level >> 7;
            }
        }
        self.votes.clear();
        self.votes.resize(width, 0);
        for shift in 0..=2 * radius {
            for (sum, &column) in self.votes.iter_mut().zip(&self.columns[shift..]) {
                *sum += column;
            }
        }
    }
}

/// Decides on pixels around which equally many vote.
fn settle(pixels: &[u8], votes: &[u8], voters: u16, out: &mut [u8]) {
    for ((out, &level), &votes) in out.iter_mut().zip(pixels).zip(votes) {
        // Twice the votes, plus one if the pixel itself breaks a draw.
        let votes = 2 * u16::from(votes) + u16::from(Mask::is_hand_level(level));
        *out = if votes > voters { 255 } else { 0 };
    }
}
