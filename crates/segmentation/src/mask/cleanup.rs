//! From a raw mask to one solid hand.

use crate::mask::Mask;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::mask::components::{Class, Components};
use crate::mask::majority::Majority;

/// How a mask is cleaned.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Cleanup {
    /// Half side of the square window of the majority vote, in pixels; 0 to 7, 0 for no vote.
    pub majority_radius: u32,
    /// Holes up to this share of the hand's area are filled; 0 to 1. Larger ones are real, such as
    /// the ring that a thumb and an index finger close.
    pub max_hole: f64,
    /// The smallest share of the image that can be a hand; 0 to 1. At least one pixel is asked for.
    pub min_hand: f64,
}

impl Default for Cleanup {
    fn default() -> Self {
        Self { majority_radius: 1, max_hole: 0.01, min_hand: 0.005 }
    }
}

impl Cleanup {
    pub(crate) fn check(&self) -> Result<()> {
        let radius = f64::from(self.majority_radius);
        let checks = [
            ("majority_radius", radius, 7.0, "0 to 7"),
            ("max_hole", self.max_hole, 1.0, "0 to 1"),
            ("min_hand", self.min_hand, 1.0, "0 to 1"),
        ];
        for (name, value, most, allowed) in checks {
            if !(0.0..=most).contains(&value) {
                return Err(Error::Parameter { name, value, allowed });
            }
        }
        Ok(())
    }

    /// The fewest pixels of a hand in an image of so many.
    pub(crate) fn needed(&self, pixels: usize) -> usize {
        (self.min_hand * pixels as f64).ceil().max(1.0) as usize
    }
}

/// Memory that [`clean_into`] and [`Silhouette::extract_into`](crate::Silhouette::extract_into)
/// use again.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    pub(crate) components: Components,
    majority: Majority,
}

/// Removes speckle by a majority vote, keeps the component that is the hand, fills its small holes.
///
/// In the result hand is 255 and everything else 0. At the image border
/// only pixels inside the image vote, so that the cut of the forearm keeps its width; a draw leaves
/// the pixel as it is. The hand is the largest 8-connected component; of equal ones, one that
/// touches the border. Holes are 4-connected components of background that do not touch the border.
///
/// Choosing the component and filling holes change nothing the second time; the majority vote
/// rounds sharp corners each time.
///
/// ```
/// use image::Luma;
/// use phalanx_segmentation::{Cleanup, Mask, clean};
///
/// let mut mask = Mask::from_fn(40, 30, |x, y| {
///     (15..25).contains(&x) && y >= 10
/// });
/// mask.put_pixel(3, 3, Luma([255])); // speckle
/// mask.put_pixel(20, 20, Luma([0])); // a hole
/// let cleaned = clean(&mask, &Cleanup::default())?;
/// assert!(!cleaned.is_hand(3, 3) && cleaned.is_hand(20, 20));
/// # Ok::<(), phalanx_segmentation::Error>(())
/// ```
pub fn clean(mask: &Mask, cleanup: &Cleanup) -> Result<Mask> {
    let mut cleaned = Mask::default();
    clean_into(mask, cleanup, &mut Workspace::default(), &mut cleaned)?;
    Ok(cleaned)
}

/// [`clean`] into a mask that is used again; it takes the size of `mask`. After an error its
/// pixels mean nothing.
pub fn clean_into(
    mask: &Mask,
    cleanup: &Cleanup,
    workspace: &mut Workspace,
    cleaned: &mut Mask,
) -> Result<()> {
    cleanup.check()?;
    let (width, height) = mask.dimensions();
    if cleaned.dimensions() != mask.dimensions() {
        *cleaned = Mask::new(width, height);
    }
    if width == 0 || height == 0 {
        return Err(Error::ImageTooSmall { width, height, minimum: 1 });
    }
    let (columns, pixels) = (width as usize, &mut **cleaned);
    workspace.majority.vote(mask, columns, cleanup.majority_radius as usize, pixels);

    let components = &mut workspace.components;
    let area = keep_largest(components, pixels, columns, cleanup.needed(mask.len()))?;

    let max_hole = (cleanup.max_hole * area as f64) as usize;
    components.label(pixels, columns, Class::Background);
    components
        .paint(pixels, columns, 255, |_, region| !region.touches_border && region.area <= max_hole);
    Ok(())
}

/// Erases all components but the largest and returns its area, at least `needed`.
pub(crate) fn keep_largest(
    components: &mut Components,
    pixels: &mut [u8],
    width: usize,
    needed: usize,
) -> Result<usize> {
    components.label(pixels, width, Class::Hand);
    let largest = components.largest();
    let area = largest.map_or(0, |(_, region)| region.area);
    let Some((hand, _)) = largest.filter(|_| area >= needed) else {
        return Err(Error::EmptyMask { pixels: area, needed });
    };
    components.paint(pixels, width, 0, |component, _| component != hand);
    Ok(area)
}
