//! What can be otherwise than in training: other hands, cameras that have moved, ragged
//! silhouettes. All of it is here.

use phalanx_segmentation::Mask;
use std::ops::RangeInclusive;

use glam::{DAffine3, DQuat, DVec3};
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{HandShape, Pose};
use serde::{Deserialize, Serialize};

use crate::synthesis::rng::ItemRng;
use crate::synthesis::scene::{Scene, SceneView};

/// How scenes differ from what the rig is made for. Each field that is zero leaves its part of the
/// scene as it is. Angles are radians.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Augmentation {
    /// Whose hands are seen.
    pub hands: ShapeVariation,
    /// Each camera is turned about the middle of the volume, on an axis that is uniform on the
    /// sphere, by an angle uniform in this range: it stands elsewhere and looks from there.
    pub camera_turn: RangeInclusive<f64>,
    /// Each camera is rolled about its optical axis by an angle uniform within ± this.
    pub camera_roll: f64,
    /// What happens to the silhouettes' borders.
    pub mask_noise: MaskNoise,
}

/// Whose hands are seen.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum ShapeVariation {
    /// The hand that was given.
    Given,
    /// So many hands in turn, in each of which every bone and radius of the given one is multiplied
    /// by a factor of its own, uniform within 1 ± `spread`.
    Several {
        /// How many hands, at least 1.
        count: usize,
        /// How far they differ.
        spread: f64,
    },
    /// A hand of its own for every scene, as above.
    Each {
        /// How far they differ.
        spread: f64,
    },
}

/// What happens to the silhouettes' borders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum MaskNoise {
    /// Nothing.
    None,
    /// Eroded, kept or dilated by one pixel with equal chance; then 15 % of the pixels on either
    /// side of the border flip, and 0.2 % of all pixels. Describing cleans it up again, as it
    /// does a photograph's mask.
    Boundary,
}

impl MaskNoise {
    /// Does it to a silhouette; the same with the same seed.
    pub fn apply(self, mask: &mut Mask, seed: u64) {
        match self {
            Self::None => {}
            Self::Boundary => make_ragged(mask, seed),
        }
    }
}

/// What estimators are meant to stand: a hand of its own for every scene, its bones and radii within
/// 10 % of the given one's, as far as adults' differ; cameras turned by up to 3°, as far as a tripod that
/// was touched; ragged silhouettes.
impl Default for Augmentation {
    fn default() -> Self {
        Self {
            hands: ShapeVariation::Each { spread: 0.1 },
            camera_turn: 0.0..=3.0_f64.to_radians(),
            camera_roll: 0.0,
            mask_noise: MaskNoise::Boundary,
        }
    }
}

impl Augmentation {
    /// No augmentation.
    pub const NONE: Self = Self {
        hands: ShapeVariation::Given,
        camera_turn: 0.0..=0.0,
        camera_roll: 0.0,
        mask_noise: MaskNoise::None,
    };

    /// A pose of a hand as the damaged rig sees it: the scene of this number in the run with this
    /// seed. [`SceneSource`](crate::SceneSource) of it are described like any others.
    pub fn scene(
        &self,
        rig: &Rig,
        hand: &HandShape,
        pose: Pose,
        seed: u64,
        number: usize,
    ) -> Scene {
        let mut random = ItemRng::new(seed, number as u64);
        let rest = rig.volume.rest_frame();
        let hand = self.hand(hand, seed, number);
        let view = |camera: &Camera| {
            let turn = about(
                rig.volume.center,
                random.direction(),
                random.between(*self.camera_turn.start(), *self.camera_turn.end()),
            );
            let roll = about(
                camera.centre(),
                camera.extrinsics.rotation.row(2),
                random.between(-self.camera_roll, self.camera_roll),
            );
            let ragged = random.seed();
            SceneView {
                rest: roll * turn * rest,
                ragged: (self.mask_noise == MaskNoise::Boundary).then_some(ragged),
            }
        };
        Scene { pose, hand, views: rig.cameras.iter().map(view).collect() }
    }

    /// The hand of one scene.
    fn hand(&self, given: &HandShape, seed: u64, number: usize) -> HandShape {
        // Hands and scenes have seeds apart: the eight hands are not those of the first eight
        // scenes' own.
        let varied = |hand: usize, spread: f64| {
            let mut random = ItemRng::new(!seed, hand as u64);
            given.scaled(|| random.between(1.0 - spread, 1.0 + spread))
        };
        match self.hands {
            ShapeVariation::Given => given.clone(),
            ShapeVariation::Several { count, spread } => varied(number % count.max(1), spread),
            ShapeVariation::Each { spread } => varied(number, spread),
        }
    }
}

/// The rotation about a line through a point.
fn about(point: DVec3, direction: DVec3, angle: f64) -> DAffine3 {
    let rotation = DQuat::from_axis_angle(direction.normalize_or(DVec3::Z), angle);
    DAffine3::from_rotation_translation(rotation, point - rotation * point)
}

/// The least or the greatest of the 3×3 pixels around each, fewer at the picture's border.
fn around(pixels: &[u8], width: usize, pick: impl Fn(u8, u8) -> u8) -> Vec<u8> {
    let mut across = pixels.to_vec();
    for (row, out) in pixels.chunks_exact(width).zip(across.chunks_exact_mut(width)) {
        out[1..].iter_mut().zip(row).for_each(|(out, before)| *out = pick(*out, *before));
        out.iter_mut().zip(&row[1..]).for_each(|(out, next)| *out = pick(*out, *next));
    }
    let mut all = across.clone();
    all[width..].iter_mut().zip(&across).for_each(|(out, above)| *out = pick(*out, *above));
    all.iter_mut().zip(&across[width..]).for_each(|(out, below)| *out = pick(*out, *below));
    all
}

/// Makes a silhouette [`MaskNoise::Boundary`].
pub(crate) fn make_ragged(mask: &mut Mask, seed: u64) {
    const IN_BAND: f64 = 0.15;
    const ANYWHERE: f64 = 0.002;
    let mut random = ItemRng::new(seed, 0);
    let width = mask.width() as usize;
    let moved = match random.below(3) {
        0 => around(mask, width, u8::min),
        1 => around(mask, width, u8::max),
        _ => mask.to_vec(),
    };
    let (least, most) = (around(&moved, width, u8::min), around(&moved, width, u8::max));
    for (((level, moved), least), most) in mask.iter_mut().zip(moved).zip(least).zip(most) {
        let in_band = Mask::is_hand_level(least) != Mask::is_hand_level(most);
        let flips = (random.uniform() < IN_BAND && in_band) != (random.uniform() < ANYWHERE);
        *level = if Mask::is_hand_level(moved) == flips { 0 } else { 255 };
    }
}

#[cfg(test)]
mod tests {
    use image::{GrayImage, Luma};

    use super::*;

    /// As it is told, pixel by pixel.
    fn slow(mask: &Mask, seed: u64) -> Mask {
        let (width, height) = mask.dimensions();
        let around = |mask: &Mask, x: u32, y: u32| -> Vec<bool> {
            let rows = y.saturating_sub(1)..(y + 2).min(height);
            let columns = x.saturating_sub(1)..(x + 2).min(width);
            let places = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
            places.map(|(x, y)| mask.is_hand(x, y)).collect()
        };
        let mut random = ItemRng::new(seed, 0);
        let choice = random.below(3);
        let moved = Mask::from_fn(width, height, |x, y| match choice {
            0 => around(mask, x, y).iter().all(|&hand| hand),
            1 => around(mask, x, y).iter().any(|&hand| hand),
            _ => mask.is_hand(x, y),
        });
        Mask::from_fn(width, height, |x, y| {
            let hand = moved.is_hand(x, y);
            let flips_in_band = random.uniform() < 0.15;
            let flips_anywhere = random.uniform() < 0.002;
            let in_band = around(&moved, x, y).contains(&!hand);
            hand != ((flips_in_band && in_band) != flips_anywhere)
        })
    }

    #[test]
    fn borders_are_ragged_as_pixel_by_pixel() {
        for (width, height) in [(1, 1), (1, 7), (9, 1), (2, 2), (31, 17)] {
            for seed in 0..12 {
                let mut random = ItemRng::new(7, seed);
                let levels = [0, 100, 127, 128, 200, 255];
                let patches: Vec<u8> = (0..80).map(|_| levels[random.below(6)]).collect();
                let patch = |x: u32, y: u32| patches[(x / 4 + 8 * (y / 4)) as usize];
                let mask = GrayImage::from_fn(width, height, |x, y| Luma([patch(x, y)]));
                let mask = Mask::from(mask);
                let mut ragged = mask.clone();
                make_ragged(&mut ragged, seed);
                assert_eq!(ragged, slow(&mask, seed), "{width}×{height}, seed {seed}");
            }
        }
    }
}
