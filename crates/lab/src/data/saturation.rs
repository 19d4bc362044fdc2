//! Reference masks of hands before a bright, unsaturated wall, by saturation alone.

use image::{GrayImage, RgbImage};
use phalanx_segmentation::{Cleanup, clean};

/// Saturation above which a pixel is hand: Otsu's threshold on the pooled photographs of
/// `digits`, found once, before any skin model was looked at, and fixed since.
pub(crate) const THRESHOLD: u8 = 51;

/// The largest saturated region, its small holes filled; `None` where there is none.
pub(crate) fn reference_mask(photograph: &RgbImage) -> Option<GrayImage> {
    let (width, height) = photograph.dimensions();
    let raw = GrayImage::from_fn(width, height, |x, y| {
        let saturated = saturation(photograph.get_pixel(x, y).0) > THRESHOLD;
        image::Luma([if saturated { 255 } else { 0 }])
    });
    clean(&raw, &Cleanup { majority_radius: 0, ..Cleanup::default() }).ok()
}

/// HSV saturation, 0 to 255.
fn saturation(rgb: [u8; 3]) -> u8 {
    let [r, g, b] = rgb.map(u32::from);
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    (255 * (most - least)).checked_div(most).unwrap_or_default() as u8
}

/// Intersection over union of two masks of one size.
pub(crate) fn overlap(a: &GrayImage, b: &GrayImage) -> f64 {
    let (mut both, mut either) = (0_u32, 0_u32);
    for (a, b) in a.iter().zip(b.iter()) {
        both += u32::from(*a > 127 && *b > 127);
        either += u32::from(*a > 127 || *b > 127);
    }
    f64::from(both) / f64::from(either.max(1))
}
