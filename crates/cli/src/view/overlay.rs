//! Frames with the estimated hand over what each camera saw.

use anyhow::Result;
use image::{Rgb, RgbImage, imageops};
use phalanx::{Mask, draw_mask};
use phalanx_camera::Camera;
use phalanx_io::take::{Take, TakeFrame, TakeHeader};

use super::footage::Filmed;
use super::label;

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
/// has none. Above them it says which frame it is, what speaks against it, and how well each camera agrees. Both sides
/// are even numbers of pixels, as videos need them.
pub(super) fn drawn(take: &Take, frame: &TakeFrame, filmed: &mut [Filmed]) -> Result<RgbImage> {
    let even = |length: u32| length.next_multiple_of(2);
    let width: u32 = filmed.iter().map(|own| own.size().0).sum();
    let height = filmed.iter().map(|own| own.size().1).max().unwrap_or_default();
    let size = if width < NARROW { 1 } else { 2 };
    let line = LINE * size;
    let mut all = RgbImage::new(even(width), even(2 * line + height));
    let colour = if frame.is_trusted() { TRUSTED } else { DOUBTED };
    label::write(&mut all, [0, 0], (width, size), colour, &of_frame(frame));
    let mut left = 0;
    for own in filmed {
        let text = of_camera(take, frame, &own.camera.name);
        label::write(&mut all, [left, line], (own.size().0, size), WORDS, &text);
        if let Some(picture) = own.picture(frame.index)? {
            let mut picture = picture.to_rgb8();
            if let Some(hand) = silhouette(take, frame, &own.camera) {
                outline(&mut picture, &hand, colour);
            }
            imageops::replace(&mut all, &picture, i64::from(left), i64::from(2 * line));
        }
        left += own.size().0;
    }
    Ok(all)
}

/// A narrower row of pictures has small letters, px.
const NARROW: u32 = 480;
/// How high a line is at size 1, px.
pub(super) const LINE: u32 = label::CHARACTER + 2;
const WORDS: Rgb<u8> = Rgb([220; 3]);

/// Which frame it is, and what speaks against it.
fn of_frame(frame: &TakeFrame) -> String {
    format!("frame {} {:.2} s {}", frame.index, frame.time, frame.doubts.join(" "))
}

/// A camera, and how much of what it sees the hand overlaps or why it was left out.
fn of_camera(take: &Take, frame: &TakeFrame, camera: &str) -> String {
    let views = take.header.views.iter().zip(&frame.views);
    let view = views.into_iter().find(|(name, _)| *name == camera).map(|(_, view)| view);
    let left_out =
        view.and_then(|view| view.left_out).map(|reason| format!("left out: {}", reason.code()));
    let overlap = view.and_then(|view| view.overlap).map(|overlap| format!("{overlap:.2}"));
    format!("{camera} {}", left_out.or(overlap).unwrap_or_default())
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
