//! What the hand and what is behind it look like.

use glam::{DVec2, DVec3};
use image::{Rgb, RgbImage};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::error::{Error, Result};
use crate::supersampling::Supersampling;

/// How a shaded picture looks. Colours are 8-bit sRGB; light is mixed in those values, as
/// plain Lambert and Blinn–Phong shading without cast shadows.
#[derive(Debug, Clone, PartialEq)]
pub struct Appearance {
    /// Colour of fully lit skin.
    pub skin: [u8; 3],
    /// Direction from the hand to the light, in the world; of any length.
    pub light: DVec3,
    /// Share of the light that comes from everywhere, 0 to 1.
    pub ambient: f64,
    /// Strength of the highlight, 0 to 1.
    pub specular: f64,
    /// What is behind the hand.
    pub background: Background,
    /// Standard deviation of the sensor's noise in each channel, grey levels.
    pub noise_sigma: f64,
    /// Samples in a pixel, so that the hand's edge mixes with the background as in a camera.
    pub sampling: Supersampling,
}

/// What is behind the hand.
#[derive(Debug, Clone, PartialEq)]
pub enum Background {
    /// One colour.
    Plain([u8; 3]),
    /// From one colour at the picture's top to another at its bottom.
    Gradient {
        /// Colour of the top row.
        top: [u8; 3],
        /// Colour of the bottom row.
        bottom: [u8; 3],
    },
    /// A picture of the camera's size.
    Picture(RgbImage),
}

impl Default for Appearance {
    /// Light skin before a dull bluish grey, lit from above, with a little noise.
    fn default() -> Self {
        Self {
            skin: [224, 172, 140],
            light: DVec3::new(0.4, 1.0, 0.3),
            ambient: 0.45,
            specular: 0.08,
            background: Background::Plain([84, 98, 112]),
            noise_sigma: 2.0,
            sampling: Supersampling::X2,
        }
    }
}

impl Appearance {
    /// How sharp the highlight is: the exponent of Blinn and Phong.
    const SHININESS: i32 = 24;

    pub(crate) fn validate(&self, size: (u32, u32)) -> Result<()> {
        let unit = 0.0..=1.0;
        for (field, ok) in [
            ("light", self.light.is_finite() && self.light.try_normalize().is_some()),
            ("ambient", unit.contains(&self.ambient)),
            ("specular", unit.contains(&self.specular)),
            ("noise_sigma", self.noise_sigma.is_finite() && self.noise_sigma >= 0.0),
        ] {
            if !ok {
                return Err(Error::Appearance { field });
            }
        }
        match &self.background {
            Background::Picture(picture) if picture.dimensions() != size => {
                Err(Error::BackgroundSize { have: picture.dimensions(), want: size })
            }
            _ => Ok(()),
        }
    }

    /// The colour of skin; all three are unit vectors in one frame, `view` towards the eye.
    pub(crate) fn skin_colour(&self, normal: DVec3, light: DVec3, view: DVec3) -> DVec3 {
        let lit = normal.dot(light).max(0.0);
        let halfway = (light + view).normalize_or_zero();
        let highlight = if lit > 0.0 {
            self.specular * normal.dot(halfway).max(0.0).powi(Self::SHININESS)
        } else {
            0.0
        };
        colour(self.skin) * (self.ambient + (1.0 - self.ambient) * lit) + 255.0 * highlight
    }
}

impl Background {
    /// The colour behind a pixel of a picture `height` rows high.
    pub(crate) fn colour(&self, x: u32, y: u32, height: u32) -> DVec3 {
        match self {
            Self::Plain(plain) => colour(*plain),
            Self::Gradient { top, bottom } => {
                let share = f64::from(y) / f64::from(height.saturating_sub(1).max(1));
                colour(*top).lerp(colour(*bottom), share)
            }
            Self::Picture(picture) => colour(picture.get_pixel(x, y).0),
        }
    }
}

/// A camera's sensor: adds noise, pixel by pixel in the order of the rows, and rounds.
pub(crate) struct Sensor {
    random: Pcg64Mcg,
    sigma: f64,
}

impl Sensor {
    pub(crate) fn new(sigma: f64, seed: u64) -> Self {
        Self { random: Pcg64Mcg::seed_from_u64(seed), sigma }
    }

    pub(crate) fn record(&mut self, colour: DVec3) -> Rgb<u8> {
        let ([r, g], [b, _]) = (self.gaussians(), self.gaussians());
        let noisy = colour + DVec3::new(r, g, b) * self.sigma;
        // The cast clamps to 0..=255.
        Rgb(noisy.round().to_array().map(|channel| channel as u8))
    }

    /// Two standard normal numbers (Box and Muller, 1958).
    fn gaussians(&mut self) -> [f64; 2] {
        let mut uniform = || ((self.random.next_u64() >> 11) as f64 + 0.5) / (1u64 << 53) as f64;
        let radius = (-2.0 * uniform().ln()).sqrt();
        let DVec2 { x, y } = DVec2::from_angle(std::f64::consts::TAU * uniform()) * radius;
        [x, y]
    }
}

fn colour(rgb: [u8; 3]) -> DVec3 {
    DVec3::from_array(rgb.map(f64::from))
}
