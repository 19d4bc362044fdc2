//! Masks told from photographs, whichever they are given as.

use anyhow::{Result, ensure};
use image::{DynamicImage, Rgb, RgbImage};
use phalanx::{mask_from, photograph_from};
use phalanx_segmentation::Mask;

/// The greatest difference between the channels of a pixel without colour, levels: what a JPEG file's
/// rounding makes of a grey one.
pub(crate) const GREY: u8 = 8;

/// How far the black and white of masks are off after a lossy encoding, levels.
pub(crate) const OFF_BLACK_AND_WHITE: u8 = 24;

/// A level of a mask is that of all pixels but one of so many of those that are hand, or of the others. JPEG makes it one
/// of 5 at worst; of a hand in drawn photographs it is two of 3, as of all in real ones.
const STRAY: usize = 3;

/// How far the two levels of a mask are off after a lossy encoding, levels.
const OFF_LEVEL: u8 = 12;

/// The mask that a picture is.
///
/// # Errors
/// A picture that is like a photograph.
pub(crate) fn given_mask(picture: &DynamicImage) -> Result<Mask> {
    let mask = mask_from(picture);
    let levels = Levels::of(&mask);
    let shades = levels.shades();
    // A soft border has shades too, but they are grey and few. A mask of other levels than black and white has two.
    let is_photograph =
        !levels.are_two() && (2 * shades > levels.all() || 2 * coloured(picture, &mask) > shades);
    ensure!(
        !is_photograph,
        "it is like a photograph, not like a mask: {:.0} % of its pixels are neither black nor white",
        100.0 * shades as f64 / levels.all() as f64
    );
    Ok(mask)
}

/// Whether a picture has black and white and little else, each to within so many levels: videos and JPEG
/// files of masks are blurred where black meets white.
pub(crate) fn is_like_a_mask(photograph: &RgbImage, off: u8) -> bool {
    let grey = if off == 0 { 0 } else { GREY };
    let (mut black, mut white) = (0_usize, 0_usize);
    for pixel in photograph.pixels() {
        if !is_grey(*pixel, grey) {
            return false;
        }
        black += usize::from(pixel.0[0] <= off);
        white += usize::from(pixel.0[0] >= 255 - off);
    }
    let others = photograph.pixels().len() - black - white;
    let most = if off == 0 { 0 } else { photograph.pixels().len() / 10 };
    black > 0 && white > 0 && others <= most
}

/// Whether a photograph has light and shade, but no colour. One that is dark everywhere has neither.
pub(crate) fn is_without_colour(photograph: &RgbImage) -> bool {
    let bright = |pixel: &Rgb<u8>| pixel.0.into_iter().max() > Some(DARK);
    photograph.pixels().any(bright) && photograph.pixels().all(|pixel| is_grey(*pixel, GREY))
}

/// What a camera shows that sees nothing, levels at most: its noise, in the dark.
const DARK: u8 = 64;

/// Why a photograph without colour is refused where skin is looked for.
pub(crate) const NO_COLOUR: &str = "the picture has no colour, and skin is found by its colour: give colour photographs, or \
                                    masks with --mask, or see --segment";

/// Whether the channels of a pixel differ by no more than so many levels.
pub(crate) fn is_grey(Rgb([red, green, blue]): Rgb<u8>, most: u8) -> bool {
    red.max(green).max(blue) - red.min(green).min(blue) <= most
}

/// How many pixels have each level.
struct Levels([usize; 256]);

impl Levels {
    fn of(mask: &Mask) -> Self {
        let mut levels = [0; 256];
        mask.iter().for_each(|&level| levels[usize::from(level)] += 1);
        Self(levels)
    }

    fn all(&self) -> usize {
        self.0.iter().sum()
    }

    /// Pixels that are neither black nor white.
    fn shades(&self) -> usize {
        (0..=u8::MAX)
            .zip(self.0)
            .filter(|(level, _)| is_shade(*level))
            .map(|(_, count)| count)
            .sum()
    }

    /// Whether what is hand has one level and the rest has another.
    fn are_two(&self) -> bool {
        let (rest, hand): (Vec<_>, Vec<_>) =
            (0..=u8::MAX).zip(self.0).partition(|(level, _)| !Mask::is_hand_level(*level));
        is_one(&rest) && is_one(&hand)
    }
}

/// Whether most pixels of some levels are near their median.
fn is_one(levels: &[(u8, usize)]) -> bool {
    let all: usize = levels.iter().map(|(_, count)| count).sum();
    let mut below = 0;
    let median = levels.iter().find(|(_, count)| {
        below += count;
        2 * below >= all
    });
    let is_off = |level: u8| median.is_some_and(|(median, _)| level.abs_diff(*median) > OFF_LEVEL);
    let off: usize =
        levels.iter().filter(|(level, _)| is_off(*level)).map(|(_, count)| count).sum();
    STRAY * off <= all
}

/// How many pixels that are neither black nor white have a colour.
fn coloured(picture: &DynamicImage, mask: &Mask) -> usize {
    let photograph = photograph_from(picture);
    let pixels = photograph.pixels().zip(mask.iter());
    pixels.filter(|(pixel, level)| is_shade(**level) && !is_grey(**pixel, GREY)).count()
}

fn is_shade(level: u8) -> bool {
    let black_or_white = [0, u8::MAX];
    black_or_white.iter().all(|end| level.abs_diff(*end) > OFF_BLACK_AND_WHITE)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use image::{ImageFormat, Rgba, RgbaImage, imageops};

    use super::*;

    /// A disc with an arm, of one colour on another, as much of the picture as a hand is.
    fn drawn(hand: Rgb<u8>, rest: Rgb<u8>) -> RgbImage {
        RgbImage::from_fn(120, 90, |x, y| {
            let is_disc = (i64::from(x) - 60).pow(2) + (i64::from(y) - 40).pow(2) < 18_i64.pow(2);
            if is_disc || (50..70).contains(&x) && y > 40 { hand } else { rest }
        })
    }

    fn as_jpeg(picture: &RgbImage) -> DynamicImage {
        let mut jpeg = Cursor::new(Vec::new());
        picture.write_to(&mut jpeg, ImageFormat::Jpeg).unwrap();
        image::load_from_memory(jpeg.get_ref()).unwrap()
    }

    #[test]
    fn masks_are_masks_however_they_are_stored() {
        let (black, white) = (Rgb([0; 3]), Rgb([255; 3]));
        let others = [(Rgb([200; 3]), Rgb([50; 3])), (Rgb([250, 230, 40]), Rgb([60, 0, 80]))];
        for (hand, rest) in [(white, black), (black, white), (white, white)].iter().chain(&others) {
            let mask = drawn(*hand, *rest);
            for stored in [mask.clone().into(), as_jpeg(&mask)] {
                given_mask(&stored).unwrap();
            }
        }
        for sigma in [1.0, 3.0, 6.0] {
            let soft = imageops::blur(&drawn(white, black), sigma);
            given_mask(&soft.clone().into()).unwrap();
            given_mask(&as_jpeg(&soft)).unwrap();
        }
        let ones = given_mask(&drawn(Rgb([1; 3]), black).into()).unwrap();
        assert!(ones.iter().all(|level| *level <= 1));
        let skin = |x: u32| Rgba([120 + x as u8, 90 + x as u8, 60, if x > 60 { 0 } else { 255 }]);
        given_mask(&RgbaImage::from_fn(120, 90, |x, _| skin(x / 2)).into()).unwrap();
    }

    #[test]
    fn photographs_are_told() {
        let shaded = |Rgb([red, green, blue]): Rgb<u8>, x: u32| {
            Rgb([red, green, blue].map(|level| (u32::from(level) * (40 + 5 * x % 100) / 140) as u8))
        };
        let (skin, grey) = (Rgb([235, 180, 150]), Rgb([190; 3]));
        for (hand, rest) in [(skin, grey), (skin, Rgb([0; 3])), (skin, Rgb([255; 3])), (grey, grey)]
        {
            let mut photograph = drawn(hand, rest);
            for (x, _, pixel) in photograph.enumerate_pixels_mut() {
                // A dark or bright wall is as even as a mask's.
                if *pixel == hand || rest == grey {
                    *pixel = shaded(*pixel, x);
                }
            }
            let refusal = given_mask(&photograph.into()).err().unwrap().to_string();
            assert!(refusal.contains("it is like a photograph"), "{refusal}");
        }
    }
}
