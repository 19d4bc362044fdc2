//! Photographs of drawn hands in several lights.

use anyhow::Result;
use image::RgbImage;
use phalanx::Scene;
use phalanx_camera::{Camera, Rig};
use phalanx_render::{Appearance, Background, Renderer};

/// The photographs' size, px.
const SIZE: (u32, u32) = (320, 240);

/// How a hand is lit, and its skin.
#[derive(Clone, Copy)]
pub(super) enum Light {
    Usual,
    Dark,
    Warm,
    DarkSkin,
}

impl Light {
    pub(super) const ALL: [Self; 4] = [Self::Usual, Self::Dark, Self::Warm, Self::DarkSkin];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Usual => "usual light",
            Self::Dark => "dark light",
            Self::Warm => "warm light",
            Self::DarkSkin => "dark skin",
        }
    }

    /// The photographs of a scene by every camera.
    pub(super) fn photographs(self, rig: &Rig, scene: &Scene, seed: u64) -> Result<Vec<RgbImage>> {
        let appearance = self.appearance();
        let photograph = |(camera, view): (&Camera, &phalanx::SceneView)| -> Result<RgbImage> {
            let camera = camera.with_intrinsics(camera.intrinsics.resized(SIZE.0, SIZE.1));
            let solids = scene.hand.pose(&scene.pose, &view.rest).primitives;
            Ok(Renderer::new(&camera)?.shade(&solids, &appearance, seed)?)
        };
        rig.cameras.iter().zip(&scene.views).map(photograph).collect()
    }

    fn appearance(self) -> Appearance {
        let usual = Appearance::default();
        match self {
            Self::Usual => usual,
            Self::Dark => tinted(&usual, [0.3, 0.3, 0.3]),
            Self::Warm => tinted(&usual, [1.0, 0.72, 0.42]),
            Self::DarkSkin => Appearance { skin: [92, 60, 44], ..usual },
        }
    }
}

/// The same in light of another colour.
fn tinted(usual: &Appearance, light: [f64; 3]) -> Appearance {
    let lit = |colour: [u8; 3]| {
        let mut lit = [0; 3];
        for ((lit, level), light) in lit.iter_mut().zip(colour).zip(light) {
            *lit = (f64::from(level) * light) as u8;
        }
        lit
    };
    let background = match &usual.background {
        Background::Plain(colour) => Background::Plain(lit(*colour)),
        Background::Gradient { top, bottom } => {
            Background::Gradient { top: lit(*top), bottom: lit(*bottom) }
        }
        Background::Picture(picture) => Background::Picture(picture.clone()),
    };
    Appearance { skin: lit(usual.skin), background, ..usual.clone() }
}
