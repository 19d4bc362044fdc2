//! Pictures from the bytes of their files.

use std::io::Cursor;
use std::panic::catch_unwind;

use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use super::jpeg::{self, Marks};
use crate::error::{Error, Result};

/// The longest side of a picture that is decoded, px.
const MOST_PIXELS_ASIDE: u32 = 16_384;

/// How much more memory decoding a file may take than the picture does. Of a progressive JPEG file all
/// coefficients are kept, two bytes each, of up to four channels; a WebP file is held in planes, and as a
/// picture with alpha before; a TIFF file in strips beside the picture.
fn memory_times(format: ImageFormat) -> u64 {
    match format {
        ImageFormat::Jpeg | ImageFormat::WebP => 4,
        ImageFormat::Tiff => 2,
        _ => 1,
    }
}

/// Decodes a PNG, JPEG, PNM, WebP, BMP or TIFF file, the right way up: cameras that were turned say so in
/// the file. JPEG files may lack what webcams leave out: Huffman tables that are the standard's, or
/// nothing but the mark of their end. `most_memory` bounds what decoding may take, in bytes; 2^30 is
/// enough for any camera.
///
/// ```
/// use phalanx::{Error, decode_picture};
///
/// let picture = decode_picture(b"P2 3 2 255  0 128 255  9 9 9", 1 << 20)?; // text says PGM, too
/// assert_eq!(picture.to_luma8().get_pixel(1, 0).0, [128]);
/// assert!(matches!(decode_picture(b"P2 3 2 255", 1 << 20), Err(Error::Undecodable { .. })));
/// # Ok::<(), Error>(())
/// ```
///
/// # Errors
///
/// [`Error::TruncatedPicture`] for a JPEG file that lacks its end; [`Error::LargePicture`] for one that
/// would take too much memory; [`Error::Undecodable`] for whatever else is wrong with a file, or a side
/// above 16,384 px. Where damage makes a decoder panic, the panic's hook is called before.
pub fn decode_picture(file: &[u8], most_memory: u64) -> Result<DynamicImage> {
    let format = image::guess_format(file).map_err(undecodable)?;
    if format == ImageFormat::Jpeg {
        return decode_jpeg(file, most_memory);
    }
    if format == ImageFormat::Png && has_part_of_a_colour(file) {
        let reason = "a PNG palette ends within a colour".to_owned();
        return Err(Error::Undecodable { reason });
    }
    decode_guarded(file, format, most_memory)
}

/// A JPEG file, also without what webcams leave out.
fn decode_jpeg(file: &[u8], most_memory: u64) -> Result<DynamicImage> {
    let marks = Marks::of(file);
    let file = marks.with_tables(file);
    if marks.is_whole {
        return decode_guarded(&file, ImageFormat::Jpeg, most_memory);
    }
    // A decoder fills what is missing with grey, and a grey hand is no hand.
    if !marks.may_lack_its_end_only {
        return Err(Error::TruncatedPicture);
    }
    let mut decoded: Option<DynamicImage> = None;
    for whole in jpeg::ended(&file) {
        let next = decode_guarded(&whole, ImageFormat::Jpeg, most_memory)?;
        if decoded.is_some_and(|before| before != next) {
            return Err(Error::TruncatedPicture);
        }
        decoded = Some(next);
    }
    decoded.ok_or(Error::TruncatedPicture)
}

/// The decoders are not ours, and notice some damage only where an assertion fails.
fn decode_guarded(file: &[u8], format: ImageFormat, most_memory: u64) -> Result<DynamicImage> {
    catch_unwind(|| decode(file, format, most_memory))
        .unwrap_or_else(|_| Err(Error::Undecodable { reason: "its decoder panicked".to_owned() }))
}

/// An image error's text tells its cause already. The JPEG decoder quotes some causes together with the
/// end of their line.
fn undecodable(error: ImageError) -> Error {
    let reason = match error {
        ImageError::Limits(_) => format!(
            "it is larger than {MOST_PIXELS_ASIDE} px on a side, or takes too much memory; scale it down"
        ),
        other => other.to_string().replace("\\n\"", "\""),
    };
    Error::Undecodable { reason }
}

fn decode(file: &[u8], format: ImageFormat, most_memory: u64) -> Result<DynamicImage> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_PIXELS_ASIDE);
    limits.max_image_height = Some(MOST_PIXELS_ASIDE);
    limits.max_alloc = Some(most_memory);
    let mut reader = ImageReader::with_format(Cursor::new(file), format);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(undecodable)?;
    let needed = decoder.total_bytes().saturating_mul(memory_times(format));
    if needed > most_memory {
        let (width, height) = decoder.dimensions();
        return Err(Error::LargePicture { width, height, needed, most: most_memory });
    }
    let orientation = decoder.orientation().map_err(undecodable)?;
    let mut image = DynamicImage::from_decoder(decoder).map_err(undecodable)?;
    image.apply_orientation(orientation);
    Ok(image)
}

/// Whether a PNG file has a palette whose length is no multiple of three. The decoder takes for
/// granted that there is none, and panics.
fn has_part_of_a_colour(png: &[u8]) -> bool {
    const SIGNATURE: usize = 8;
    const NAME_AND_CHECKSUM: usize = 8;
    let mut ahead = png.get(SIGNATURE..).unwrap_or_default();
    while let Some((length, chunk)) = ahead.split_first_chunk() {
        let length = u32::from_be_bytes(*length) as usize;
        if chunk.starts_with(b"PLTE") && !length.is_multiple_of(3) {
            return true;
        }
        ahead = chunk.get(length.saturating_add(NAME_AND_CHECKSUM)..).unwrap_or_default();
    }
    false
}

#[cfg(test)]
mod tests {
    use image::GrayImage;

    use super::*;

    #[test]
    fn what_a_jpeg_decoder_keeps_counts() {
        let picture = GrayImage::new(100, 100);
        let mut file = Cursor::new(Vec::new());
        picture.write_to(&mut file, ImageFormat::Jpeg).expect("room enough");
        let file = file.into_inner();
        assert!(matches!(decode_picture(&file, 30_000), Err(Error::LargePicture { .. })));
        assert_eq!(decode_picture(&file, 100_000).expect("a picture").width(), 100);
    }

    /// A picture in which all blocks differ, as a JPEG file.
    fn file() -> Vec<u8> {
        let level = |x: u32, y: u32| (x * 7 + y * 13 + (x * y) % 31) as u8;
        let colour = |x, y| image::Rgb([level(x, y), level(y, x), level(x + y, x)]);
        let mut file = Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(96, 80, colour);
        picture.write_to(&mut file, ImageFormat::Jpeg).expect("room enough");
        file.into_inner()
    }

    #[test]
    fn a_file_may_lack_its_end_and_nothing_else() {
        let whole = file();
        let decoded = decode_picture(&whole, 1 << 24).expect("a picture");
        let without_end = whole.strip_suffix(&[0xff, 0xd9]).expect("an end");
        assert_eq!(decode_picture(without_end, 1 << 24).expect("all is there"), decoded);
        for missing in [4, 10, 100, 1000] {
            let cut = &without_end[..without_end.len() - missing];
            let refused = decode_picture(cut, 1 << 24);
            assert!(matches!(refused, Err(Error::TruncatedPicture)), "{missing} bytes");
        }
    }

    /// Motion JPEG leaves out the tables that are the standard's, which this encoder uses.
    #[test]
    fn the_standard_s_tables_may_be_left_out() {
        let whole = file();
        let mut without = whole.clone();
        while let Some(at) = without.windows(2).position(|mark| mark == [0xff, 0xc4]) {
            let length = usize::from(u16::from_be_bytes([without[at + 2], without[at + 3]]));
            without.drain(at..at + 2 + length);
        }
        assert!(without.len() < whole.len() - 300);
        let decoded = decode_picture(&without, 1 << 24).expect("a picture");
        assert_eq!(decoded, decode_picture(&whole, 1 << 24).expect("a picture"));
    }

    #[test]
    fn all_formats_are_read() {
        let picture = image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([x as u8, y as u8, 200]));
        for format in [
            ImageFormat::Png,
            ImageFormat::Pnm,
            ImageFormat::WebP,
            ImageFormat::Bmp,
            ImageFormat::Tiff,
        ] {
            let mut file = Cursor::new(Vec::new());
            picture.write_to(&mut file, format).expect("room enough");
            let decoded = decode_picture(file.get_ref(), 1 << 20).expect("a picture");
            assert_eq!(decoded.to_rgb8(), picture, "{format:?}");
        }
    }
}
