//! Pictures beside and below each other, and how silhouettes look in them.

use phalanx_segmentation::Mask;
use std::borrow::Borrow;

use image::{Rgb, RgbImage, imageops};

/// What surrounds pictures, and is behind silhouettes.
const MARGIN: Rgb<u8> = Rgb([255, 255, 255]);
const BEHIND: Rgb<u8> = Rgb([34, 40, 49]);

/// Panels row by row, so many in each, `gap` pixels between them; a cell is as large as the
/// largest panel.
pub(crate) fn mosaic<P: Borrow<RgbImage>>(panels: &[P], columns: u32, gap: u32) -> RgbImage {
    let sides = |side: fn(&RgbImage) -> u32| panels.iter().map(move |panel| side(panel.borrow()));
    let most = |side| sides(side).max().unwrap_or_default();
    let (width, height) = (most(RgbImage::width) + gap, most(RgbImage::height) + gap);
    let rows = (panels.len() as u32).div_ceil(columns);
    let size = (width * columns).saturating_sub(gap).max(1);
    let mut sheet = RgbImage::from_pixel(size, (height * rows).saturating_sub(gap).max(1), MARGIN);
    for (k, panel) in (0..).zip(panels) {
        let (x, y) = (k % columns * width, k / columns * height);
        imageops::replace(&mut sheet, panel.borrow(), x.into(), y.into());
    }
    sheet
}

/// A silhouette in one colour before a dark ground.
pub(crate) fn tinted(mask: &Mask, colour: [u8; 3]) -> RgbImage {
    RgbImage::from_fn(mask.width(), mask.height(), |x, y| {
        if mask.is_hand(x, y) { Rgb(colour) } else { BEHIND }
    })
}

/// A picture whose pixels can be seen.
pub(crate) fn magnified(picture: &RgbImage, times: u32) -> RgbImage {
    let (width, height) = (picture.width() * times, picture.height() * times);
    imageops::resize(picture, width, height, imageops::FilterType::Nearest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_follow_each_other_row_by_row() {
        let panel = |level| RgbImage::from_pixel(2, 1, Rgb([level; 3]));
        let sheet = mosaic(&[panel(1), panel(2), panel(3)], 2, 1);
        assert_eq!(sheet.dimensions(), (5, 3));
        let at = |x, y| sheet.get_pixel(x, y).0[0];
        assert_eq!([at(0, 0), at(3, 0), at(0, 2), at(2, 0), at(4, 2)], [1, 2, 3, 255, 255]);
    }
}
