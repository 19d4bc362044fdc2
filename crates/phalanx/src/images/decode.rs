//! Pictures from the bytes of their files.

use std::io::Cursor;
use std::panic::catch_unwind;

use image::{
    DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, ImageResult, Limits,
};

use crate::error::{Error, Result};

/// The longest side of a picture that is decoded, px.
const MOST_PIXELS_ASIDE: u32 = 16_384;
/// How much more memory decoding a JPEG file may take than the picture does: of a progressive one all
/// coefficients are kept, two bytes each, of up to four channels.
const JPEG_TIMES: u64 = 4;

/// Decodes a PNG, JPEG or PNM file, the right way up: cameras that were turned say so in the file.
/// `most_memory` bounds what decoding may take, in bytes; 2^30 is enough for any camera.
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
/// [`Error::TruncatedPicture`] for a JPEG file that lacks its end; [`Error::Undecodable`] for whatever
/// else is wrong with a file, a side above 16,384 px or too much memory. Where damage makes a decoder
/// panic, the panic's hook is called before.
pub fn decode_picture(file: &[u8], most_memory: u64) -> Result<DynamicImage> {
    // An image error's text tells its cause already. The JPEG decoder quotes some causes together
    // with the end of their line.
    let undecodable =
        |error: ImageError| Error::Undecodable { reason: error.to_string().replace("\\n\"", "\"") };
    let format = image::guess_format(file).map_err(undecodable)?;
    if format == ImageFormat::Jpeg && is_cut_off(file) {
        return Err(Error::TruncatedPicture);
    }
    if format == ImageFormat::Png && has_part_of_a_colour(file) {
        let reason = "a PNG palette ends within a colour".to_owned();
        return Err(Error::Undecodable { reason });
    }
    // The decoders are not ours, and notice some damage only where an assertion fails.
    match catch_unwind(|| decode(file, format, most_memory)) {
        Ok(decoded) => decoded.map_err(undecodable),
        Err(_) => Err(Error::Undecodable { reason: "its decoder panicked".to_owned() }),
    }
}

fn decode(file: &[u8], format: ImageFormat, most_memory: u64) -> ImageResult<DynamicImage> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_PIXELS_ASIDE);
    limits.max_image_height = Some(MOST_PIXELS_ASIDE);
    limits.max_alloc = Some(most_memory);
    let mut reader = ImageReader::with_format(Cursor::new(file), format);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder()?;
    let times = if format == ImageFormat::Jpeg { JPEG_TIMES } else { 1 };
    limits.reserve(decoder.total_bytes().saturating_mul(times))?;
    let orientation = decoder.orientation()?;
    let mut image = DynamicImage::from_decoder(decoder)?;
    image.apply_orientation(orientation);
    Ok(image)
}

/// Whether a JPEG file stops before its end-of-image mark. The decoder would fill the rest with
/// grey, and a grey hand is no hand. What follows that mark, such as a maker's trailer, may hold
/// anything; what is wrong before it is for the decoder to say.
fn is_cut_off(jpeg: &[u8]) -> bool {
    const END_OF_IMAGE: u8 = 0xd9;
    const START_OF_SCAN: u8 = 0xda;
    let (mut ahead, mut in_scan) = (jpeg, false);
    loop {
        ahead = match *ahead {
            [] | [0xff] => return true,
            [0xff, END_OF_IMAGE, ..] => return false,
            // The start of the image and restarts have no segment; marks may be filled up in front.
            [0xff, 0x01 | 0xd0..=0xd8, ref after @ ..] => after,
            [0xff, 0xff, ..] => &ahead[1..],
            [0xff, mark @ 1..=0xfe, ref segment @ ..] => {
                let Some(&length) = segment.first_chunk() else { return true };
                let length = usize::from(u16::from_be_bytes(length));
                if length < 2 {
                    return false;
                }
                in_scan = mark == START_OF_SCAN;
                segment.get(length..).unwrap_or_default()
            }
            [_, ref after @ ..] if in_scan => after,
            _ => return false,
        }
    }
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
        assert!(matches!(decode_picture(&file, 30_000), Err(Error::Undecodable { .. })));
        assert_eq!(decode_picture(&file, 100_000).expect("a picture").width(), 100);
    }
}
