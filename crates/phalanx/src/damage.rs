//! What can be otherwise than in training: other hands, cameras that have moved, ragged
//! silhouettes. All of it is here.

use std::ops::RangeInclusive;

use glam::{DAffine3, DQuat, DVec3};
use image::{GrayImage, Luma};
use phalanx_camera::{Camera, Rig};
use phalanx_hand::{HandShape, Pose};

use crate::{ItemRandom, Scene, View};

/// How scenes differ from what the rig is made for. Each field that is zero leaves its part of the
/// scene as it is. Angles are radians.
#[derive(Debug, Clone, PartialEq)]
pub struct Damage {
    /// Whose hands are seen.
    pub hands: Hands,
    /// Each camera is turned about the middle of the volume, on an axis that is uniform on the
    /// sphere, by an angle uniform in this range: it stands elsewhere and looks from there.
    pub camera_turn: RangeInclusive<f64>,
    /// Each camera is rolled about its optical axis by an angle uniform within ± this.
    pub camera_roll: f64,
    /// What happens to the silhouettes' borders.
    pub border: Border,
}

/// Whose hands are seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hands {
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Border {
    /// Nothing.
    Clean,
    /// Eroded, kept or dilated by one pixel with equal chance; then 15 % of the pixels on either
    /// side of the border flip, and 0.2 % of all pixels. Describing cleans it up again, as it
    /// does a photograph's mask.
    Ragged,
}

impl Damage {
    /// Nothing is damaged.
    pub const NONE: Self = Self {
        hands: Hands::Given,
        camera_turn: 0.0..=0.0,
        camera_roll: 0.0,
        border: Border::Clean,
    };

    /// A pose of a hand as the damaged rig sees it: the scene of this number in the run with this
    /// seed. [`Scenes`](crate::Scenes) of it are described like any others.
    pub fn scene(
        &self,
        rig: &Rig,
        hand: &HandShape,
        pose: Pose,
        seed: u64,
        number: usize,
    ) -> Scene {
        let mut random = ItemRandom::new(seed, number as u64);
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
            View {
                rest: roll * turn * rest,
                ragged: (self.border == Border::Ragged).then_some(ragged),
            }
        };
        Scene { pose, hand, views: rig.cameras.iter().map(view).collect() }
    }

    /// The hand of one scene.
    fn hand(&self, given: &HandShape, seed: u64, number: usize) -> HandShape {
        // Hands and scenes have seeds apart: the eight hands are not those of the first eight
        // scenes' own.
        let varied = |hand: usize, spread: f64| {
            let mut random = ItemRandom::new(!seed, hand as u64);
            given.varied(|| random.between(1.0 - spread, 1.0 + spread))
        };
        match self.hands {
            Hands::Given => given.clone(),
            Hands::Several { count, spread } => varied(number % count.max(1), spread),
            Hands::Each { spread } => varied(number, spread),
        }
    }
}

/// The rotation about a line through a point.
fn about(point: DVec3, direction: DVec3, angle: f64) -> DAffine3 {
    let rotation = DQuat::from_axis_angle(direction.normalize_or(DVec3::Z), angle);
    DAffine3::from_rotation_translation(rotation, point - rotation * point)
}

/// The pixels within one of each pixel, the picture going on beyond its border as it ends.
fn neighbours(mask: &GrayImage, x: u32, y: u32) -> impl Iterator<Item = bool> + '_ {
    let (right, bottom) = (mask.width() - 1, mask.height() - 1);
    let rows = y.saturating_sub(1)..=(y + 1).min(bottom);
    rows.flat_map(move |y| {
        (x.saturating_sub(1)..=(x + 1).min(right)).map(move |x| is_hand(mask, x, y))
    })
}

fn is_hand(mask: &GrayImage, x: u32, y: u32) -> bool {
    mask.get_pixel(x, y).0[0] > 127
}

fn level(hand: bool) -> Luma<u8> {
    Luma([if hand { 255 } else { 0 }])
}

/// Makes a silhouette [`Border::Ragged`].
pub(crate) fn make_ragged(mask: &mut GrayImage, seed: u64) {
    const IN_BAND: f64 = 0.15;
    const ANYWHERE: f64 = 0.002;
    let mut random = ItemRandom::new(seed, 0);
    let (width, height) = mask.dimensions();
    let moved = match random.below(3) {
        0 => {
            GrayImage::from_fn(width, height, |x, y| level(neighbours(mask, x, y).all(|hand| hand)))
        }
        1 => {
            GrayImage::from_fn(width, height, |x, y| level(neighbours(mask, x, y).any(|hand| hand)))
        }
        _ => mask.clone(),
    };
    *mask = GrayImage::from_fn(width, height, |x, y| {
        let hand = is_hand(&moved, x, y);
        let in_band = neighbours(&moved, x, y).any(|other| other != hand);
        let flips = (random.uniform() < IN_BAND && in_band) != (random.uniform() < ANYWHERE);
        level(hand != flips)
    });
}
