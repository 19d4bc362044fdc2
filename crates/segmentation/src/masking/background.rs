//! A hand before a recorded background.

use image::RgbImage;

use crate::mask::Mask;
use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// When a pixel is no longer background.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BackgroundParams {
    /// The noise of a channel is taken to be at least this standard deviation, in levels; positive.
    pub noise_floor: f64,
    /// A colour further than this many standard deviations from the background is hand; positive.
    pub threshold: f64,
    /// A shadow leaves at least this share of the background's brightness; 0 to 1, 1 for no shadows.
    pub shadow: f64,
}

impl Default for BackgroundParams {
    fn default() -> Self {
        Self { noise_floor: 3.0, threshold: 5.0, shadow: 0.4 }
    }
}

/// Everything that a [`BackgroundModel`] is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BackgroundParts {
    /// When a pixel is no longer background.
    pub params: BackgroundParams,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Mean red, green, blue of each pixel, row-major, 0 to 255.
    pub mean: Vec<[f32; 3]>,
    /// Standard deviation of a channel of each pixel, in levels; 0 if there was one frame.
    pub noise: Vec<f32>,
}

/// Tells a hand from a background that was recorded without it, by the camera that stands still.
///
/// As in Horprasert et al. (1999) a colour is compared with the background's in two ways: how much
/// brighter or darker it is, and how far off the line through black it is. Somewhat darker in the
/// same hue is a shadow, and no hand.
///
/// ```
/// use image::{Rgb, RgbImage};
/// use phalanx_segmentation::{BackgroundModel, BackgroundParams};
///
/// let desk = RgbImage::from_pixel(32, 24, Rgb([120, 130, 140]));
/// let model = BackgroundModel::from_frames(&[desk.clone()], BackgroundParams::default())?;
/// let mut picture = desk;
/// picture.put_pixel(5, 6, Rgb([210, 150, 120])); // skin
/// picture.put_pixel(8, 9, Rgb([96, 104, 112])); // a shadow
/// let mask = model.segment(&picture)?;
/// assert_eq!((mask[(5, 6)].0, mask[(8, 9)].0), ([255], [0]));
/// # Ok::<(), phalanx_segmentation::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "BackgroundParts", into = "BackgroundParts")]
pub struct BackgroundModel {
    parts: BackgroundParts,
}

impl BackgroundModel {
    /// Learns from frames of the background alone, all of one size. With one frame the noise is
    /// the floor; with several it is measured in each pixel.
    pub fn from_frames(frames: &[RgbImage], params: BackgroundParams) -> Result<Self> {
        let first = frames.first().ok_or(Error::NoFrames)?;
        let (width, height) = first.dimensions();
        let mut sums = vec![[0_u64; 3]; width as usize * height as usize];
        let mut squares = vec![0_u64; sums.len()];
        for frame in frames {
            same_size("background frame", (width, height), frame)?;
            let (colours, _) = frame.as_raw().as_chunks::<3>();
            for ((sum, square), colour) in sums.iter_mut().zip(&mut squares).zip(colours) {
                for (sum, level) in sum.iter_mut().zip(colour.map(u64::from)) {
                    *sum += level;
                    *square += level * level;
                }
            }
        }
        let count = frames.len() as f64;
        let mean = |sum: &[u64; 3]| sum.map(|sum| (sum as f64 / count) as f32);
        let noise = |(sum, &square): (&[u64; 3], &u64)| {
            let of_means: f64 = sum.iter().map(|&sum| (sum as f64).powi(2) / count).sum();
            let degrees = 3.0 * (count - 1.0).max(1.0);
            ((square as f64 - of_means).max(0.0) / degrees).sqrt() as f32
        };
        let noise = sums.iter().zip(&squares).map(noise).collect();
        let mean = sums.iter().map(mean).collect();
        Self::from_parts(BackgroundParts { params, width, height, mean, noise })
    }

    /// Builds the model from its parts.
    pub fn from_parts(parts: BackgroundParts) -> Result<Self> {
        let BackgroundParams { noise_floor, threshold, shadow } = parts.params;
        let pixels = u64::from(parts.width) * u64::from(parts.height);
        let level = |v: &f32| (0.0..=255.0).contains(v);
        let positive = |v: f64| v > 0.0 && v.is_finite();
        let (means, noises) = (parts.mean.len(), parts.noise.len());
        let checks = [
            ("noise_floor", noise_floor, positive(noise_floor), "positive and finite"),
            ("threshold", threshold, positive(threshold), "positive and finite"),
            ("shadow", shadow, (0.0..=1.0).contains(&shadow), "0 to 1"),
            ("mean colours", means as f64, means as u64 == pixels, "one for each pixel"),
            ("noise values", noises as f64, noises as u64 == pixels, "one for each pixel"),
        ];
        for (name, value, ok, allowed) in checks {
            if !ok {
                return Err(Error::Parameter { name, value, allowed });
            }
        }
        let values = || parts.mean.as_flattened().iter().chain(&parts.noise);
        if let Some(&value) = values().find(|value| !level(value)) {
            let (name, allowed) = ("background level", "0 to 255");
            return Err(Error::Parameter { name, value: value.into(), allowed });
        }
        Ok(Self { parts })
    }

    /// What the model is made of.
    pub fn parts(&self) -> &BackgroundParts {
        &self.parts
    }

    /// The mask of the hand, 255 in it and 0 elsewhere, as large as the image, which is as large as
    /// the recorded background.
    pub fn segment(&self, image: &RgbImage) -> Result<Mask> {
        let BackgroundParts { params, width, height, mean, noise } = &self.parts;
        same_size("image", (*width, *height), image)?;
        let mut mask = Mask::new(*width, *height);
        let (colours, _) = image.as_raw().as_chunks::<3>();
        let background = mean.iter().zip(noise);
        for ((level, &rgb), (&mean, &noise)) in mask.iter_mut().zip(colours).zip(background) {
            *level = if params.is_hand(rgb, mean, noise) { 255 } else { 0 };
        }
        Ok(mask)
    }
}

impl BackgroundParams {
    fn is_hand(&self, rgb: [u8; 3], background: [f32; 3], noise: f32) -> bool {
        let rgb = rgb.map(f32::from);
        let limit = self.threshold as f32 * noise.max(self.noise_floor as f32);
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let distance_to = |scale: f32| {
            let off: [f32; 3] = std::array::from_fn(|c| rgb[c] - scale * background[c]);
            dot(off, off).sqrt()
        };
        let norm = dot(background, background);
        let brightness = if norm > 0.0 { dot(rgb, background) / norm } else { 1.0 };
        // The nearest colour that is background, lit fully or in shadow.
        distance_to(brightness.clamp(self.shadow as f32, 1.0)) > limit
    }
}

fn same_size(what: &'static str, expected: (u32, u32), image: &RgbImage) -> Result<()> {
    let found = image.dimensions();
    if found == expected { Ok(()) } else { Err(Error::SizeMismatch { what, expected, found }) }
}

impl TryFrom<BackgroundParts> for BackgroundModel {
    type Error = Error;

    fn try_from(parts: BackgroundParts) -> Result<Self> {
        Self::from_parts(parts)
    }
}

impl From<BackgroundModel> for BackgroundParts {
    fn from(model: BackgroundModel) -> Self {
        model.parts
    }
}
