//! A hand before a plain wall.

use image::RgbImage;

use crate::mask::Mask;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};
use crate::masking::otsu::otsu;

/// A plain wall behind the hand, evenly coloured but perhaps unevenly lit. It needs no training
/// and no recorded background, and the hand may cover less than half of the image border.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum PlainBackground {
    /// Bright and paler than the hand: the hand is what is more saturated than the wall. Shadows on
    /// the wall change its brightness and not its hue, and are no hand.
    Bright,
    /// Dark: the hand is what is brighter than the wall.
    Dark,
}

/// Hand and wall must differ by so many of 255 levels of saturation or brightness.
const LEAST_CONTRAST: f64 = 20.0;

/// Below this level, of 255, channels are too noisy for saturation to mean much.
const DARKEST: f32 = 32.0;

impl PlainBackground {
    /// The mask of the hand, 255 in it and 0 elsewhere, as large as the image. The wall's colour is
    /// the median along the image border, and the threshold is Otsu's.
    ///
    /// ```
    /// use image::{Rgb, RgbImage};
    /// use phalanx_segmentation::PlainBackground;
    ///
    /// let picture = RgbImage::from_fn(40, 30, |x, y| {
    ///     Rgb(if (15..25).contains(&x) && y >= 10 { [200, 140, 110] } else { [230, 230, 228] })
    /// });
    /// let mask = PlainBackground::Bright.segment(&picture)?;
    /// assert!(mask.is_hand(20, 20) && !mask.is_hand(2, 2));
    /// # Ok::<(), phalanx_segmentation::Error>(())
    /// ```
    pub fn segment(self, image: &RgbImage) -> Result<Mask> {
        let (width, height) = image.dimensions();
        if width == 0 || height == 0 {
            return Err(Error::ImageTooSmall { width, height, minimum: 1 });
        }
        let wall = border_median(image);
        let mut mask = Mask::new(width, height);
        let mut histogram = [0_u32; 256];
        let (colours, _) = image.as_raw().as_chunks::<3>();
        for (level, &rgb) in mask.iter_mut().zip(colours) {
            *level = self.contrast(rgb, wall);
            histogram[usize::from(*level)] += 1;
        }
        let (threshold, difference) = otsu(&histogram);
        if difference < LEAST_CONTRAST {
            return Err(Error::NoContrast { difference, needed: LEAST_CONTRAST });
        }
        mask.iter_mut().for_each(|level| *level = if *level > threshold { 255 } else { 0 });
        Ok(mask)
    }

    /// How much a pixel stands out from the wall, in levels.
    fn contrast(self, rgb: [u8; 3], wall: [u8; 3]) -> u8 {
        let rgb = rgb.map(f32::from);
        match self {
            Self::Bright => {
                let brightest = wall.into_iter().fold(1, u8::max);
                let relative: [f32; 3] = std::array::from_fn(|c| {
                    rgb[c] * f32::from(brightest) / f32::from(wall[c].max(1))
                });
                let (most, least) = range(relative);
                (255.0 * (most - least) / most.max(DARKEST)) as u8
            }
            Self::Dark => (range(rgb).0 - range(wall.map(f32::from)).0) as u8,
        }
    }
}

/// The largest and the smallest channel.
fn range(channels: [f32; 3]) -> (f32, f32) {
    (channels.into_iter().fold(0.0, f32::max), channels.into_iter().fold(f32::MAX, f32::min))
}

fn border_median(image: &RgbImage) -> [u8; 3] {
    let (right, bottom) = (image.width() - 1, image.height() - 1);
    let rows = (0..=right).flat_map(|x| [(x, 0), (x, bottom)]);
    let border = rows.chain((0..=bottom).flat_map(|y| [(0, y), (right, y)]));
    let colours: Vec<[u8; 3]> = border.map(|(x, y)| image.get_pixel(x, y).0).collect();
    std::array::from_fn(|c| {
        let mut channel: Vec<u8> = colours.iter().map(|colour| colour[c]).collect();
        let middle = channel.len() / 2;
        *channel.select_nth_unstable(middle).1
    })
}
