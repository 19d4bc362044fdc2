//! Why no hand is found in a picture.

use image::{Rgb, RgbImage};
use phalanx::{Error, Estimator, Segmenter};
use phalanx_segmentation::Error as Reason;

use crate::segment::Prepared;

/// The greatest difference between the channels of a pixel without colour, levels: what a JPEG file's
/// rounding makes of a grey one.
const GREY: u8 = 8;

/// The error of an estimate from pictures. Where no hand was found, it says what the picture is like.
pub(crate) fn explained(
    error: Error,
    estimator: &Estimator,
    pictures: &[Prepared<'_>],
) -> anyhow::Error {
    let Error::Silhouette { camera, reason } = &error else { return error.into() };
    let mut views = estimator.rig().cameras.iter().zip(pictures);
    match (views.find(|(seeing, _)| seeing.name == *camera), reason) {
        (
            Some((_, Prepared::Photograph(photograph, Segmenter::Skin(_)))),
            Reason::EmptyMask { .. },
        ) => anyhow::anyhow!("{error}; {}", cause(photograph)),
        (Some((_, picture)), _) if picture.as_picture().looks_inverted() => {
            anyhow::anyhow!("{error}; the mask looks inverted: hand should be white")
        }
        _ => error.into(),
    }
}

fn cause(photograph: &RgbImage) -> &'static str {
    let is_grey = |Rgb([red, green, blue]): &Rgb<u8>| {
        red.max(green).max(blue) - red.min(green).min(blue) <= GREY
    };
    let sum =
        |channel: usize| photograph.pixels().map(|pixel| u64::from(pixel[channel])).sum::<u64>();
    if photograph.pixels().all(is_grey) {
        "the picture has no colour, and skin is found by its colour: give colour photographs, or masks \
         with --mask, or see --segment"
    } else if sum(2) > sum(0) {
        "there is more blue than red in the picture, so the light may be too cold for skin to be found by \
         its colour: set the camera's white balance, give masks with --mask, or see --segment"
    } else {
        "nothing as large as a hand has the colour of skin: look at the light and the white balance, or \
         give masks with --mask, or see --segment"
    }
}
