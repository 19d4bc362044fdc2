//! Why no hand is found in a picture.

use image::RgbImage;
use phalanx::{Cause, Error, Estimator, LossReason, Segmenter};
use phalanx_segmentation::Error as Reason;

use crate::mask::{GREY, NO_COLOUR, is_grey};
use crate::segment::Prepared;

/// The error of an estimate from pictures. Where no hand was found, it says what the picture is like.
pub(crate) fn explained(
    error: Error,
    estimator: &Estimator,
    pictures: &[Option<Prepared<'_>>],
) -> anyhow::Error {
    let Error::Silhouette { camera, reason } = &error else { return error.into() };
    let mut views = estimator.rig().cameras.iter().zip(pictures);
    let Some((_, Some(picture))) = views.find(|(seeing, _)| seeing.name == *camera) else {
        return error.into();
    };
    match like(picture, matches!(reason, Reason::EmptyMask { .. })) {
        Some(like) => anyhow::anyhow!("{error}; {like}"),
        None => error.into(),
    }
}

/// What the picture of a view is like in which no hand was found.
pub(crate) fn why(cause: Cause, picture: &Prepared<'_>) -> Option<&'static str> {
    let Cause::NotSeen(reason) = cause else { return None };
    like(picture, reason == LossReason::NoHand)
}

/// What a picture is like that shows no silhouette of a hand, or nothing at all.
fn like(picture: &Prepared<'_>, is_empty: bool) -> Option<&'static str> {
    match picture {
        Prepared::Photograph(photograph, Segmenter::Skin(_)) if is_empty => Some(cause(photograph)),
        picture => picture
            .as_picture()
            .looks_inverted()
            .then_some("the mask looks inverted: hand should be white"),
    }
}

fn cause(photograph: &RgbImage) -> &'static str {
    let sum =
        |channel: usize| photograph.pixels().map(|pixel| u64::from(pixel[channel])).sum::<u64>();
    if photograph.pixels().all(|pixel| is_grey(*pixel, GREY)) {
        NO_COLOUR
    } else if sum(2) > sum(0) {
        "there is more blue than red in the picture, so the light may be too cold for skin to be found by \
         its colour: set the camera's white balance, give masks with --mask, or see --segment"
    } else {
        "nothing as large as a hand has the colour of skin: look at the light and the white balance, or \
         give masks with --mask, or see --segment"
    }
}
