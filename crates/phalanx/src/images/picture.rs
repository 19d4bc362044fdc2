//! What a camera gives.

use image::{DynamicImage, RgbImage};
use phalanx_segmentation::{BackgroundModel, Mask, PlainBackground, Segment, SkinModel};
use serde::{Deserialize, Serialize};

use crate::error::Result;

/// One camera's picture of the hand.
#[derive(Debug, Clone, Copy)]
pub enum Picture<'a> {
    /// A colour photograph and how to find the hand in it.
    Photograph(&'a RgbImage, &'a dyn Segment),
    /// A silhouette.
    Mask(&'a Mask),
}

impl Picture<'_> {
    /// Width and height, px.
    pub fn size(&self) -> (u32, u32) {
        match self {
            Self::Photograph(image, _) => image.dimensions(),
            Self::Mask(mask) => mask.dimensions(),
        }
    }

    /// Whether it is a mask and looks inverted: more of its border is hand than not.
    pub fn looks_inverted(&self) -> bool {
        let Self::Mask(mask) = self else { return false };
        let (width, height) = mask.dimensions();
        let is_border = |x: u32, y: u32| x == 0 || y == 0 || x + 1 == width || y + 1 == height;
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let border = pixels.filter(|&(x, y)| is_border(x, y));
        let (hand, all) = border.fold((0_usize, 0_usize), |(hand, all), (x, y)| {
            (hand + usize::from(mask.is_hand(x, y)), all + 1)
        });
        2 * hand > all
    }

    /// The raw mask, as large as the picture.
    pub(crate) fn mask(&self) -> Result<Mask, phalanx_segmentation::Error> {
        match self {
            Self::Photograph(image, segmenter) => segmenter.segment(image),
            Self::Mask(mask) => Ok((*mask).clone()),
        }
    }
}

/// The silhouette that a picture holds. Where a part of it is transparent, the hand is what is opaque:
/// of one colour, as a mask in the alpha channel, all of it; else what of it is bright.
///
/// ```
/// use image::{DynamicImage, Rgba, RgbaImage};
///
/// // Black where it is opaque, black where it is not.
/// let alpha = RgbaImage::from_fn(4, 1, |x, _| Rgba([0, 0, 0, if x < 3 { 255 } else { 0 }]));
/// let mask = phalanx::mask_from(&DynamicImage::from(alpha));
/// assert!(mask.is_hand(2, 0) && !mask.is_hand(3, 0));
/// ```
pub fn mask_from(picture: &DynamicImage) -> Mask {
    let mut mask = Mask::from(picture.to_luma8());
    let Some(alpha) = varying_alpha(picture) else { return mask };
    let opaque = Mask::is_hand_level;
    let levels = || mask.iter().zip(&alpha).filter(|&(_, &alpha)| opaque(alpha));
    let is_bright = |&(level, _): &(&u8, &u8)| Mask::is_hand_level(*level);
    let is_one_colour =
        levels().all(|pair| is_bright(&pair)) || !levels().any(|pair| is_bright(&pair));
    for (level, alpha) in mask.iter_mut().zip(alpha) {
        *level = match (opaque(alpha), is_one_colour) {
            (false, _) => 0,
            (true, true) => 255,
            (true, false) => *level,
        };
    }
    mask
}

/// The photograph that a picture holds: what is transparent is black, whatever colour is hidden there.
pub fn photograph_from(picture: &DynamicImage) -> RgbImage {
    let mut photograph = picture.to_rgb8();
    if let Some(alpha) = varying_alpha(picture) {
        for (pixel, alpha) in photograph.pixels_mut().zip(alpha) {
            pixel.0 = pixel.0.map(|level| (u16::from(level) * u16::from(alpha) / 255) as u8);
        }
    }
    photograph
}

/// How opaque each pixel is, if some are not.
fn varying_alpha(picture: &DynamicImage) -> Option<Vec<u8>> {
    if !picture.color().has_alpha() {
        return None;
    }
    let alpha: Vec<u8> = picture.to_rgba8().pixels().map(|pixel| pixel.0[3]).collect();
    alpha.iter().any(|alpha| *alpha < 255).then_some(alpha)
}

/// How the hand is told from the rest of a photograph.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Segmenter {
    /// By the colour of skin (§ 2 of the paper), adapted to each picture.
    Skin(SkinModel),
    /// By its difference from the recorded background of the same camera, at the size at which it is segmented: the
    /// working size, or the picture's where windows are described.
    Background(BackgroundModel),
    /// By its difference from a plain wall.
    PlainBackground(PlainBackground),
}

impl Segment for Segmenter {
    fn segment(&self, picture: &RgbImage) -> phalanx_segmentation::Result<Mask> {
        match self {
            Self::Skin(model) => model.segment(picture),
            Self::Background(model) => model.segment(picture),
            Self::PlainBackground(background) => background.segment(picture),
        }
    }
}

#[cfg(test)]
mod tests {
    use image::{Rgba, RgbaImage};

    use super::*;

    const SKIN: [u8; 3] = [205, 150, 125];

    /// A picture of three pixels: opaque, half transparent, transparent.
    fn cut_out(colours: [[u8; 3]; 3]) -> DynamicImage {
        let pixel = |x: u32, _| {
            let ([r, g, b], alpha) = (colours[x as usize], [255, 128, 0][x as usize]);
            Rgba([r, g, b, alpha])
        };
        RgbaImage::from_fn(3, 1, pixel).into()
    }

    #[test]
    fn a_mask_may_be_in_the_alpha_channel_in_any_colour() {
        for colour in [[0; 3], [255; 3], SKIN] {
            assert_eq!(mask_from(&cut_out([colour; 3])).as_raw(), &[255, 255, 0], "{colour:?}");
        }
        // Bright on dark where it is opaque: that tells the hand, and alpha what is nothing.
        let mask = mask_from(&cut_out([[0; 3], [255; 3], [255; 3]]));
        assert_eq!(mask.as_raw(), &[0, 255, 0]);
        let opaque = cut_out([[0; 3], [255; 3], [255; 3]]).to_rgb8();
        assert_eq!(mask_from(&opaque.into()).as_raw(), &[0, 255, 255]);
    }

    #[test]
    fn what_is_transparent_hides_no_skin() {
        let photograph = photograph_from(&cut_out([SKIN; 3]));
        assert_eq!(photograph.get_pixel(0, 0).0, SKIN);
        assert_eq!(photograph.get_pixel(1, 0).0, [102, 75, 62]);
        assert_eq!(photograph.get_pixel(2, 0).0, [0; 3]);
    }
}
