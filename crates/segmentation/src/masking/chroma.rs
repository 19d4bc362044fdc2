//! The chromatic plane of YCbCr.

/// Grey, and half a level to round.
const CENTRE: i32 = (128 << 16) + (1 << 15);

/// Blue and red chroma (Cb, Cr) of an sRGB pixel: ITU-R BT.601 in full range, as in JPEG files,
/// rounded to whole levels; grey is (128, 128).
///
/// ```
/// use phalanx_segmentation::chroma;
///
/// assert_eq!(chroma([90, 90, 90]), (128, 128));
/// let (blue, red) = chroma([205, 150, 125]); // skin
/// assert!(blue < 128 && red > 128);
/// ```
#[inline]
pub fn chroma([r, g, b]: [u8; 3]) -> (u8, u8) {
    let [r, g, b] = [i32::from(r), i32::from(g), i32::from(b)];
    // In units of 2⁻¹⁶, with a half to round; the coefficients of a row sum to zero.
    let cb = (-11_059 * r - 21_709 * g + 32_768 * b + CENTRE) >> 16;
    let cr = (32_768 * r - 27_439 * g - 5_329 * b + CENTRE) >> 16;
    (cb.min(255) as u8, cr.min(255) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_definition_in_reals() {
        for step in 0..1 << 12 {
            let rgb = [step % 16 * 17, step / 16 % 16 * 17, step / 256 * 17].map(|v| v as u8);
            let [r, g, b] = rgb.map(f64::from);
            let luma = 0.299 * r + 0.587 * g + 0.114 * b;
            let (cb, cr) = chroma(rgb);
            assert!((f64::from(cb) - 128.0 - (b - luma) / 1.772).abs() < 0.51);
            assert!((f64::from(cr) - 128.0 - (r - luma) / 1.402).abs() < 0.51);
        }
    }
}
