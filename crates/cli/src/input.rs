//! Reading models and pictures.

use std::path::Path;
use std::str::FromStr;

use anyhow::{Context, Result, bail};
use image::DynamicImage;
use phalanx::{Estimator, decode_picture};
use phalanx_cli::reading;
use phalanx_hand::HandShape;

/// The most memory that decoding a picture may take, bytes.
const MOST_MEMORY: u64 = 1 << 30;

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
    let bytes = reading::read(path).with_context(|| path.display().to_string())?;
    Estimator::from_bytes(&bytes).with_context(|| path.display().to_string())
}

/// Reads a hand file.
pub(crate) fn hand(path: &Path) -> Result<HandShape> {
    let name = || path.display().to_string();
    let text = reading::read_text(path).with_context(name)?;
    HandShape::from_toml(&text).with_context(name)
}

/// Reads a picture, and of it the window if one is given.
pub(crate) fn picture(path: &Path, crop: Option<Crop>) -> Result<DynamicImage> {
    let read = || {
        let image = decode_picture(&reading::read(path)?, MOST_MEMORY)?;
        match crop {
            Some(crop) => crop.of(&image),
            None => Ok(image),
        }
    };
    read().with_context(|| path.display().to_string())
}
