//! Reference masks of hands before a bright, unsaturated wall, by saturation alone.

use image::RgbImage;
use phalanx_segmentation::{Cleanup, Mask, clean};

/// Saturation above which a pixel is hand: Otsu's threshold on the pooled photographs of
/// `digits`, found once, before any skin model was looked at, and fixed since.
pub(crate) const THRESHOLD: u8 = 51;

/// The largest saturated region, its small holes filled; `None` where there is none.
pub(crate) fn reference_mask(photograph: &RgbImage) -> Option<Mask> {
    let (width, height) = photograph.dimensions();
    let raw =
        Mask::from_fn(width, height, |x, y| saturation(photograph.get_pixel(x, y).0) > THRESHOLD);
    clean(&raw, &Cleanup { majority_radius: 0, ..Cleanup::default() }).ok()
}

/// HSV saturation, 0 to 255.
fn saturation(rgb: [u8; 3]) -> u8 {
    let [r, g, b] = rgb.map(u32::from);
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    (255 * (most - least)).checked_div(most).unwrap_or_default() as u8
}
