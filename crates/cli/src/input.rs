//! Reading models and pictures.

use std::path::Path;
use std::str::FromStr;

use anyhow::{Context, Result, anyhow, bail};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, ImageResult, Limits};
use phalanx::Estimator;
use phalanx_hand::HandShape;

/// The longest side of a picture that is decoded, px.
const MOST_PIXELS_ASIDE: u32 = 16_384;
/// The most memory that decoding a picture may take, bytes.
const MOST_BYTES: u64 = 1 << 30;

/// A window of a picture, px: `X,Y,W,H`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crop {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl FromStr for Crop {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let numbers = text.split(',').map(|number| number.trim().parse::<u32>());
        let numbers: Vec<u32> = numbers.collect::<Result<_, _>>().context("expected X,Y,W,H")?;
        match numbers[..] {
            [x, y, width, height] if width > 0 && height > 0 => Ok(Self { x, y, width, height }),
            _ => bail!("expected X,Y,W,H with a width and a height"),
        }
    }
}

impl Crop {
    fn of(self, image: &DynamicImage) -> Result<DynamicImage> {
        let Self { x, y, width, height } = self;
        let fits = |start: u32, length: u32, end: u32| {
            start.checked_add(length).is_some_and(|stop| stop <= end)
        };
        if !fits(x, width, image.width()) || !fits(y, height, image.height()) {
            bail!(
                "the window {x},{y},{width},{height} reaches outside the picture of {}×{}",
                image.width(),
                image.height()
            );
        }
        Ok(image.crop_imm(x, y, width, height))
    }
}

/// Reads a model file.
pub(crate) fn model(path: &Path) -> Result<Estimator> {
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    Estimator::from_bytes(&bytes).with_context(|| path.display().to_string())
}

/// Reads a hand file.
pub(crate) fn hand(path: &Path) -> Result<HandShape> {
    let name = || path.display().to_string();
    let text = std::fs::read_to_string(path).with_context(name)?;
    HandShape::from_toml(&text).with_context(name)
}

/// Reads a picture, and of it the window if one is given.
pub(crate) fn picture(path: &Path, crop: Option<Crop>) -> Result<DynamicImage> {
    let read = || {
        let image = decode(path)?;
        match crop {
            Some(crop) => crop.of(&image),
            None => Ok(image),
        }
    };
    read().with_context(|| path.display().to_string())
}

/// Decodes a picture, the right way up: cameras that were turned say so in the file.
fn decode(path: &Path) -> Result<DynamicImage> {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_PIXELS_ASIDE);
    limits.max_image_height = Some(MOST_PIXELS_ASIDE);
    limits.max_alloc = Some(MOST_BYTES);
    let mut reader = ImageReader::open(path)?.with_guessed_format()?;
    if reader.format() == Some(ImageFormat::Jpeg) && is_cut_off(&std::fs::read(path)?) {
        bail!("the JPEG file is truncated");
    }
    reader.limits(limits.clone());
    let decoded = || -> ImageResult<DynamicImage> {
        let mut decoder = reader.into_decoder()?;
        limits.reserve(decoder.total_bytes())?;
        let orientation = decoder.orientation()?;
        let mut image = DynamicImage::from_decoder(decoder)?;
        image.apply_orientation(orientation);
        Ok(image)
    };
    // An image error's text tells its cause already. The JPEG decoder quotes some causes together
    // with the end of their line.
    decoded().map_err(|error| anyhow!("{}", error.to_string().replace("\\n\"", "\"")))
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
