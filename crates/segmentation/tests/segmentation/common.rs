//! Masks for tests.

use phalanx_segmentation::Mask;
use proptest::prelude::*;

/// Discs, some beyond the border, with speckle.
pub(crate) fn masks() -> impl Strategy<Value = Mask> {
    (16..40_u32, 16..40_u32).prop_flat_map(|(width, height)| {
        let disc = (-4..44_i32, -4..44_i32, 0..12_i32);
        let speck = (0..width, 0..height);
        let discs = proptest::collection::vec(disc, 1..5);
        let specks = proptest::collection::vec(speck, 0..60);
        (discs, specks).prop_map(move |(discs, specks)| draw(width, height, &discs, &specks))
    })
}

fn draw(width: u32, height: u32, discs: &[(i32, i32, i32)], specks: &[(u32, u32)]) -> Mask {
    let mut mask = Mask::from_fn(width, height, |x, y| {
        let inside = |&(cx, cy, r): &(i32, i32, i32)| {
            (x as i32 - cx).pow(2) + (y as i32 - cy).pow(2) <= r * r
        };
        discs.iter().any(inside)
    });
    for &(x, y) in specks {
        let level = mask.get_pixel_mut(x, y);
        level.0[0] = 255 - level.0[0];
    }
    mask
}

/// The mask that a drawing of `#` and anything else stands for.
pub(crate) fn drawing(rows: &[&str]) -> Mask {
    Mask::from_fn(rows[0].len() as u32, rows.len() as u32, |x, y| {
        rows[y as usize].as_bytes()[x as usize] == b'#'
    })
}

/// The mask moved to (x, y) of an empty canvas.
pub(crate) fn placed(mask: &Mask, (width, height): (u32, u32), (x, y): (u32, u32)) -> Mask {
    let mut canvas = Mask::new(width, height);
    image::imageops::replace(&mut *canvas, &**mask, x.into(), y.into());
    canvas
}
