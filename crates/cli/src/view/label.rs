//! Words in pictures.

use font8x8::{BASIC_FONTS, UnicodeFonts};
use image::{Rgb, RgbImage};

/// How wide and high a character is at size 1, px.
pub(super) const CHARACTER: u32 = 8;

/// Writes a line from a place on, in characters of so many times their size; what does not fit into the `width` is left
/// out. A letter that the font lacks is a question mark.
pub(super) fn write(
    picture: &mut RgbImage,
    [left, top]: [u32; 2],
    (width, size): (u32, u32),
    colour: Rgb<u8>,
    text: &str,
) {
    let fitting = (width / (CHARACTER * size)) as usize;
    for (k, letter) in text.chars().take(fitting).enumerate() {
        let rows = BASIC_FONTS.get(letter).or_else(|| BASIC_FONTS.get('?')).unwrap_or_default();
        let left = left + CHARACTER * size * k as u32;
        for (x, y) in (0..CHARACTER * size).flat_map(|y| (0..CHARACTER * size).map(move |x| (x, y)))
        {
            let is_set = rows[(y / size) as usize] >> (x / size) & 1 == 1;
            if is_set && left + x < picture.width() && top + y < picture.height() {
                picture.put_pixel(left + x, top + y, colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_letter_stands_where_it_is_written_and_what_does_not_fit_is_left_out() {
        let white = Rgb([255; 3]);
        let written = |text: &str, width: u32| {
            let mut picture = RgbImage::new(64, 16);
            write(&mut picture, [16, 0], (width, 2), white, text);
            picture
        };
        let one = written("I", 48);
        assert!(one.pixels().any(|pixel| *pixel == white));
        let mut set = one.enumerate_pixels().filter(|(.., pixel)| **pixel == white);
        assert!(set.all(|(x, ..)| (16..32).contains(&x)));
        assert_eq!(written("IJK", 16), one);
        assert_eq!(written("\u{4e2d}", 48), written("?", 48));
    }
}
