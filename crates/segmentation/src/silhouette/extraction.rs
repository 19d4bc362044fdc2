//! A cleaned mask with its contour and the end of its forearm.

use crate::mask::Mask;

use crate::error::{Error, Result};
use crate::mask::cleanup::{Workspace, keep_largest};
use crate::silhouette::contour::Contour;
use crate::silhouette::forearm::{Forearm, ForearmCue};

/// The shortest side of an image with a silhouette, in pixels.
pub const MIN_SIDE: u32 = 16;

/// The hand in one view.
#[derive(Debug, Clone, PartialEq)]
pub struct Silhouette {
    /// 255 in the hand, 0 elsewhere; one component.
    pub mask: Mask,
    /// Its outer contour.
    pub contour: Contour,
    /// Where its forearm ends.
    pub forearm: Forearm,
}

impl Default for Silhouette {
    /// An empty silhouette, for [`Silhouette::extract_into`] to fill.
    fn default() -> Self {
        let (end, sides) = ([0.0; 2], [[0.0; 2]; 2]);
        let forearm = Forearm { end, sides, cue: ForearmCue::SmoothEnd, crossings: 0 };
        Self { mask: Mask::default(), contour: Contour::default(), forearm }
    }
}

impl Silhouette {
    /// The silhouette of a clean mask, at least [`MIN_SIDE`] pixels wide and high. Of several components the largest is taken, as in [`clean`](crate::clean).
    ///
    /// ```
    /// use phalanx_segmentation::{ForearmCue, Mask, Silhouette};
    ///
    /// let mask = Mask::from_fn(40, 30, |x, y| {
    ///     (15..25).contains(&x) && y >= 10
    /// });
    /// let silhouette = Silhouette::from_mask(&mask)?;
    /// assert_eq!(silhouette.forearm.end, [20.0, 29.5]);
    /// assert_eq!(silhouette.forearm.cue, ForearmCue::Border);
    /// # Ok::<(), phalanx_segmentation::Error>(())
    /// ```
    pub fn from_mask(mask: &Mask) -> Result<Self> {
        let mut silhouette = Self::default();
        silhouette.extract_into(mask, &mut Workspace::default())?;
        Ok(silhouette)
    }

    /// [`Silhouette::from_mask`] in this silhouette's memory. After an error its content means
    /// nothing.
    pub fn extract_into(&mut self, mask: &Mask, workspace: &mut Workspace) -> Result<()> {
        let (width, height) = mask.dimensions();
        if width.min(height) < MIN_SIDE {
            return Err(Error::ImageTooSmall { width, height, minimum: MIN_SIDE });
        }
        if self.mask.dimensions() != mask.dimensions() {
            self.mask = Mask::new(width, height);
        }
        for (own, &level) in self.mask.iter_mut().zip(mask.iter()) {
            *own = if Mask::is_hand_level(level) { 255 } else { 0 };
        }
        let pixels = keep_largest(&mut workspace.components, &mut self.mask, width as usize, 1)?;
        self.contour.trace_again(&self.mask);
        if self.contour.points.is_empty() {
            return Err(Error::NoContour { pixels, width, height });
        }
        self.forearm = Forearm::find(&self.mask, &self.contour)?;
        Ok(())
    }
}
