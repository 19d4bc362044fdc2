//! Reference masks of hands before a bright, unsaturated wall, by saturation alone.

use image::{GrayImage, RgbImage};
use phalanx_segmentation::{Cleanup, clean};

/// Saturation above which a pixel is hand: one threshold for all photographs, Otsu's on their
/// pooled histogram, chosen before any skin model is looked at.
pub(crate) struct SaturationThreshold(pub(crate) u8);

impl SaturationThreshold {
    pub(crate) fn of(photographs: &[(String, RgbImage)]) -> Self {
        let mut histogram = [0_u64; 256];
        for pixel in photographs.iter().flat_map(|(_, image)| image.pixels()) {
            histogram[usize::from(saturation(pixel.0))] += 1;
        }
        Self(otsu(&histogram))
    }

    /// The largest saturated region, its holes filled; `None` where there is none.
    pub(crate) fn mask(&self, photograph: &RgbImage) -> Option<GrayImage> {
        let (width, height) = photograph.dimensions();
        let raw = GrayImage::from_fn(width, height, |x, y| {
            let saturated = saturation(photograph.get_pixel(x, y).0) > self.0;
            image::Luma([if saturated { 255 } else { 0 }])
        });
        clean(&raw, &Cleanup { majority_radius: 0, ..Cleanup::default() }).ok()
    }
}

/// HSV saturation, 0 to 255.
fn saturation(rgb: [u8; 3]) -> u8 {
    let [r, g, b] = rgb.map(u32::from);
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    (255 * (most - least)).checked_div(most).unwrap_or_default() as u8
}

/// The level that separates a histogram into two classes of the largest variance between them;
/// the lower class ends with it.
fn otsu(histogram: &[u64; 256]) -> u8 {
    let total: f64 = histogram.iter().map(|&count| count as f64).sum();
    let moment: f64 = histogram.iter().enumerate().map(|(v, &count)| v as f64 * count as f64).sum();
    let (mut below, mut below_moment, mut best) = (0.0, 0.0, (0.0, 0));
    for (level, &count) in histogram.iter().enumerate() {
        below += count as f64;
        below_moment += level as f64 * count as f64;
        let above = total - below;
        if below > 0.0 && above > 0.0 {
            let gap = below_moment / below - (moment - below_moment) / above;
            let between = below * above * gap * gap;
            if between > best.0 {
                best = (between, level as u8);
            }
        }
    }
    best.1
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
