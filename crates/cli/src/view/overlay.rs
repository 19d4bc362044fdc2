//! Frames with the estimated hand over what each camera saw.

use anyhow::Result;
use image::{Rgb, RgbImage, imageops};
use phalanx::{Mask, draw_mask};
use phalanx_camera::Camera;
use phalanx_io::take::{Take, TakeFrame, TakeHeader};

use super::footage::Filmed;

/// The outline of the estimated hand: where the frame is in doubt, and where it is not.
const DOUBTED: Rgb<u8> = Rgb([255, 150, 30]);
const TRUSTED: Rgb<u8> = Rgb([255, 95, 200]);

/// The estimated hand of a frame as a camera sees it; `None` where there is none or it is out of sight.
pub(super) fn silhouette(take: &Take, frame: &TakeFrame, camera: &Camera) -> Option<Mask> {
    let TakeHeader { hand, world_from_hand, .. } = &take.header;
    let estimate = frame.estimate.as_ref()?;
    draw_mask(camera, hand, &estimate.pose, world_from_hand).ok()
}

/// The cameras' pictures of a frame side by side, each with the outline of the hand; black where a camera
/// has none. Both sides are even numbers of pixels, as videos need them.
pub(super) fn drawn(take: &Take, frame: &TakeFrame, filmed: &mut [Filmed]) -> Result<RgbImage> {
    let even = |length: u32| length.next_multiple_of(2);
    let width = filmed.iter().map(|own| own.size().0).sum();
    let height = filmed.iter().map(|own| own.size().1).max().unwrap_or_default();
    let mut all = RgbImage::new(even(width), even(height));
    let mut left = 0;
    for own in filmed {
        if let Some(picture) = own.picture(frame.index)? {
            let mut picture = picture.to_rgb8();
            if let Some(hand) = silhouette(take, frame, &own.camera) {
                let colour = if frame.is_trusted() { TRUSTED } else { DOUBTED };
                outline(&mut picture, &hand, colour);
            }
            imageops::replace(&mut all, &picture, left, 0);
        }
        left += i64::from(own.size().0);
    }
    Ok(all)
}

/// Draws the outline of a mask as large as the picture: its pixels that touch a pixel outside.
fn outline(picture: &mut RgbImage, mask: &Mask, colour: Rgb<u8>) {
    let (width, height) = picture.dimensions();
    let is_hand = |x: u32, y: u32| x < width && y < height && mask.is_hand(x, y);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let around = (0..9).map(|k| {
            (x.wrapping_add(k % 3).wrapping_sub(1), y.wrapping_add(k / 3).wrapping_sub(1))
        });
        if is_hand(x, y) && !around.into_iter().all(|(x, y)| is_hand(x, y)) {
            picture.put_pixel(x, y, colour);
        }
    }
}
