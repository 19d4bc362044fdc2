//! Masks of one byte a pixel: votes of neighbours, connected components, sizes.

pub(crate) mod cleanup;
pub(crate) mod components;
pub(crate) mod majority;
pub(crate) mod morphology;
pub(crate) mod resample;

use std::ops::{Deref, DerefMut};

use image::{DynamicImage, GrayImage};

/// Which pixels of a picture are hand: one byte a pixel, hand where it is over 127.
///
/// It is an image in all else, and can be used as one.
///
/// ```
/// use phalanx_segmentation::Mask;
///
/// let mask = Mask::from_fn(4, 3, |x, y| x > 1 && y > 0);
/// assert_eq!(mask.dimensions(), (4, 3));
/// assert!(mask.is_hand(2, 1) && !mask.is_hand(0, 1));
/// assert_eq!(mask.area(), 4);
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Mask(GrayImage);

impl Mask {
    /// Whether a pixel of this level is hand.
    #[inline]
    pub const fn is_hand_level(level: u8) -> bool {
        level > 127
    }

    /// A mask without a hand, `width` × `height` pixels.
    pub fn new(width: u32, height: u32) -> Self {
        Self(GrayImage::new(width, height))
    }

    /// A mask of `width` × `height` pixels, 255 where `is_hand(x, y)` says so and 0 elsewhere.
    pub fn from_fn(width: u32, height: u32, mut is_hand: impl FnMut(u32, u32) -> bool) -> Self {
        let level = |x, y| image::Luma([if is_hand(x, y) { 255 } else { 0 }]);
        Self(GrayImage::from_fn(width, height, level))
    }

    /// Whether a pixel is hand.
    ///
    /// # Panics
    /// A pixel outside the image.
    #[inline]
    pub fn is_hand(&self, x: u32, y: u32) -> bool {
        Self::is_hand_level(self.0.get_pixel(x, y).0[0])
    }

    /// The pixels that are hand, row by row.
    pub fn hand_pixels(&self) -> impl Iterator<Item = [u32; 2]> {
        let hand = self.0.enumerate_pixels().filter(|(.., level)| Self::is_hand_level(level.0[0]));
        hand.map(|(x, y, _)| [x, y])
    }

    /// How many pixels are hand.
    pub fn area(&self) -> usize {
        self.0.iter().filter(|&&level| Self::is_hand_level(level)).count()
    }

    /// Intersection over union with another mask of the same size; 0 where both are empty.
    pub fn iou(&self, other: &Self) -> f64 {
        let (mut both, mut either) = (0_u32, 0_u32);
        for (&a, &b) in self.0.iter().zip(other.0.iter()) {
            let (a, b) = (Self::is_hand_level(a), Self::is_hand_level(b));
            both += u32::from(a && b);
            either += u32::from(a || b);
        }
        f64::from(both) / f64::from(either.max(1))
    }

    /// The image.
    pub fn into_image(self) -> GrayImage {
        self.0
    }
}

impl From<GrayImage> for Mask {
    /// Hand is what is over 127.
    fn from(image: GrayImage) -> Self {
        Self(image)
    }
}

impl From<Mask> for DynamicImage {
    fn from(mask: Mask) -> Self {
        mask.0.into()
    }
}

impl Deref for Mask {
    type Target = GrayImage;

    fn deref(&self) -> &GrayImage {
        &self.0
    }
}

impl DerefMut for Mask {
    fn deref_mut(&mut self) -> &mut GrayImage {
        &mut self.0
    }
}
