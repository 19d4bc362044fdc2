//! Where the forearm ends.

use crate::mask::Mask;

use crate::error::Result;
use crate::silhouette::contour::Contour;
use crate::silhouette::forearm_end::{SmoothEnd, find_smooth_end};

/// What the end of the forearm was recognised by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForearmCue {
    /// The silhouette crosses the image border.
    Border,
    /// The silhouette crosses no border; one of its ends is a smooth stump.
    SmoothEnd,
}

/// The end of the forearm that is away from the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forearm {
    /// `[x, y]` of the middle of the end, in pixels.
    pub end: [f64; 2],
    /// `[x, y]` of where its two sides begin, in pixels: the ends of the crossing, or either side
    /// of a stump's end.
    pub sides: [[f64; 2]; 2],
    /// What it was recognised by.
    pub cue: ForearmCue,
    /// How often the silhouette crosses the image border: 1 is as it should be, 0 goes with
    /// [`ForearmCue::SmoothEnd`], and with 2 or more the longest crossing was taken.
    pub crossings: usize,
}

impl Forearm {
    /// Finds the end of the forearm of a mask of one component, of which `contour` is the contour.
    ///
    /// It is the middle of the longest run of hand pixels along the image perimeter; a run around
    /// a corner is one run. Without any, it is the end along the principal axis that is a smooth
    /// stump rather than fingers.
    pub fn find(mask: &Mask, contour: &Contour) -> Result<Self> {
        if let Some(forearm) = border_crossing(mask) {
            return Ok(forearm);
        }
        let SmoothEnd { end, sides } = find_smooth_end(mask, contour)?;
        Ok(Forearm { end, sides, cue: ForearmCue::SmoothEnd, crossings: 0 })
    }
}

/// Pixels of the perimeter, clockwise from the top left, each once.
fn perimeter(mask: &Mask) -> impl Iterator<Item = [u32; 2]> + Clone {
    let (right, bottom) = (mask.width() - 1, mask.height() - 1);
    let top = (0..right).map(|x| [x, 0]);
    let right_side = (0..bottom).map(move |y| [right, y]);
    let under = (1..=right).rev().map(move |x| [x, bottom]);
    let left = (1..=bottom).rev().map(|y| [0, y]);
    top.chain(right_side).chain(under).chain(left)
}

fn border_crossing(mask: &Mask) -> Option<Forearm> {
    let is_hand = |[x, y]: [u32; 2]| mask.is_hand(x, y);
    let length = perimeter(mask).count();
    // Starting after a background pixel, no run is split.
    let start = perimeter(mask).position(|pixel| !is_hand(pixel))?;
    let cyclic = || perimeter(mask).cycle().skip(start).take(length);

    let (mut longest, mut run, mut crossings) = (0..0, 0..0, 0);
    for (i, pixel) in cyclic().enumerate() {
        if is_hand(pixel) {
            if run.end != i || run.is_empty() {
                crossings += 1;
                run = i..i;
            }
            run.end = i + 1;
            if run.len() > longest.len() {
                longest = run.clone();
            }
        }
    }
    let centre = |i: usize| cyclic().nth(i).map(|pixel| pixel.map(|v| f64::from(v) + 0.5));
    let last = longest.end.checked_sub(1)?;
    let before = centre(usize::midpoint(longest.start, last))?;
    let after = centre((longest.start + last).div_ceil(2))?;
    let end = [f64::midpoint(before[0], after[0]), f64::midpoint(before[1], after[1])];
    let sides = [centre(longest.start)?, centre(last)?];
    Some(Forearm { end, sides, cue: ForearmCue::Border, crossings })
}
