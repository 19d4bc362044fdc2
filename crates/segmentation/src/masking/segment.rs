//! What tells the hand from the rest of a picture.

use std::fmt::Debug;

use image::RgbImage;

use crate::error::Result;
use crate::mask::Mask;
use crate::masking::adapted_skin::AdaptedSkin;
use crate::masking::background::BackgroundModel;
use crate::masking::plain_background::PlainBackground;
use crate::masking::scene::SceneModel;
use crate::masking::skin::SkinModel;

/// Tells the hand from the rest of a picture. Implement it to plug in a segmenter of your own.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use phalanx_segmentation::{Mask, Result, Segment};
///
/// /// A green glove.
/// #[derive(Debug)]
/// struct Glove;
///
/// impl Segment for Glove {
///     fn segment(&self, picture: &RgbImage) -> Result<Mask> {
///         let is_green = |x, y| {
///             let [r, g, b] = picture.get_pixel(x, y).0;
///             g > r.max(b).saturating_add(40)
///         };
///         Ok(Mask::from_fn(picture.width(), picture.height(), is_green))
///     }
/// }
///
/// let picture = RgbImage::from_fn(8, 8, |x, _| Rgb(if x < 2 { [30, 160, 40] } else { [90; 3] }));
/// assert_eq!(Glove.segment(&picture)?.area(), 16);
/// # Ok::<(), phalanx_segmentation::Error>(())
/// ```
pub trait Segment: Debug + Send + Sync {
    /// The mask of the hand, as large as the picture.
    ///
    /// # Errors
    /// A picture that the segmenter cannot work with, such as one of another size than the recorded
    /// background.
    fn segment(&self, picture: &RgbImage) -> Result<Mask>;
}

/// By the colour of skin, the model [adapted](AdaptedSkin) to each picture.
impl Segment for SkinModel {
    fn segment(&self, picture: &RgbImage) -> Result<Mask> {
        Ok(AdaptedSkin::new(self, picture).segment(picture))
    }
}

/// By its difference from the recorded background of the same camera, at the size of the picture.
impl Segment for BackgroundModel {
    fn segment(&self, picture: &RgbImage) -> Result<Mask> {
        Self::segment(self, picture)
    }
}

/// By what was learnt from the recording that the picture is of.
impl Segment for SceneModel {
    fn segment(&self, picture: &RgbImage) -> Result<Mask> {
        Self::segment(self, picture)
    }
}

/// By its difference from a plain background.
impl Segment for PlainBackground {
    fn segment(&self, picture: &RgbImage) -> Result<Mask> {
        Self::segment(*self, picture)
    }
}
