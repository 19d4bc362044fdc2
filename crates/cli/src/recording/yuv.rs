//! Colours of video to RGB.

use image::{Rgb, RgbImage};

/// How a video's luma and colour differences make red, green and blue (ITU-T H.273, table 4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Colours {
    /// Luma's share of red and of blue.
    red: f64,
    blue: f64,
    full_range: bool,
}

impl Colours {
    /// By the matrix coefficients' number in the stream. Where it names none, pictures of 720 rows and more
    /// are BT.709 and smaller ones BT.601, as players take them.
    pub(super) fn new(matrix: u8, full_range: bool, height: u32) -> Self {
        let is_709 = matrix == 1 || (matrix == 2 && height >= 720);
        let (red, blue) = match matrix {
            9 | 10 => (0.2627, 0.0593),
            _ if is_709 => (0.2126, 0.0722),
            _ => (0.299, 0.114),
        };
        Self { red, blue, full_range }
    }

    fn rgb(self, luma: f64, blue_difference: f64, red_difference: f64) -> Rgb<u8> {
        let (luma, scale) = if self.full_range {
            (luma, 1.0)
        } else {
            ((luma - 16.0) * 255.0 / 219.0, 255.0 / 224.0)
        };
        let (cb, cr) = ((blue_difference - 128.0) * scale, (red_difference - 128.0) * scale);
        let red = luma + 2.0 * (1.0 - self.red) * cr;
        let blue = luma + 2.0 * (1.0 - self.blue) * cb;
        let green = (luma - self.red * red - self.blue * blue) / (1.0 - self.red - self.blue);
        Rgb([red, green, blue].map(|level| level.round().clamp(0.0, 255.0) as u8))
    }
}

/// The planes of a picture, 8 bits a sample; colour differences are half as wide, and `chroma_height` high.
pub(super) struct Planes<'a> {
    pub(super) size: (u32, u32),
    pub(super) chroma_height: u32,
    pub(super) luma: &'a [u8],
    pub(super) blue_difference: &'a [u8],
    pub(super) red_difference: &'a [u8],
}

impl Planes<'_> {
    /// The picture; each colour difference serves the pixels that it covers.
    pub(super) fn to_rgb(&self, colours: Colours) -> RgbImage {
        let (width, height) = self.size;
        let chroma_width = (width / 2).max(1) as usize;
        RgbImage::from_fn(width, height, |x, y| {
            let row = u64::from(y) * u64::from(self.chroma_height) / u64::from(height);
            let column = (x as usize / 2).min(chroma_width - 1);
            let chroma = row as usize * chroma_width + column;
            let sample = |plane: &[u8], at: usize| f64::from(plane.get(at).copied().unwrap_or(128));
            colours.rgb(
                sample(self.luma, y as usize * width as usize + x as usize),
                sample(self.blue_difference, chroma),
                sample(self.red_difference, chroma),
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn primaries_come_out_as_they_are() {
        let colours = Colours::new(2, false, 480);
        // BT.601, limited range: the values of ITU-R BT.601 for full red, white and black.
        assert_eq!(colours.rgb(81.0, 90.0, 240.0), Rgb([254, 0, 0]));
        assert_eq!(colours.rgb(235.0, 128.0, 128.0), Rgb([255, 255, 255]));
        assert_eq!(colours.rgb(16.0, 128.0, 128.0), Rgb([0, 0, 0]));
        assert_eq!(Colours::new(1, true, 480).rgb(77.0, 128.0, 128.0), Rgb([77, 77, 77]));
    }

    #[test]
    fn colour_differences_cover_two_by_two_pixels() {
        let planes = Planes {
            size: (4, 2),
            chroma_height: 1,
            luma: &[81, 81, 235, 235, 81, 81, 235, 235],
            blue_difference: &[90, 128],
            red_difference: &[240, 128],
        };
        let picture = planes.to_rgb(Colours::new(6, false, 2));
        assert_eq!(picture.get_pixel(1, 1), &Rgb([254, 0, 0]));
        assert_eq!(picture.get_pixel(2, 0), &Rgb([255, 255, 255]));
    }
}
