//! Motion that nothing was learnt from, whole and with a piece of one view missing.

use anyhow::Result;
use image::Luma;
use phalanx::{Describer, OrientationRule, PoseContexts, draw_silhouette};
use phalanx_camera::Rig;
use phalanx_hand::{HandShape, Pose};
use phalanx_segmentation::{Mask, Silhouette};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

use crate::context::Lab;
use crate::data::data_set::{DataSet, at_seven_angles};
use crate::data::described::Described;
use crate::data::trajectories::complex_take;

/// Takes of `complex` other than the one that is learnt from, and how many of their frames are
/// taken: neighbouring frames say the same.
const TAKES: std::ops::RangeInclusive<u64> = 1..=6;
const EVERY: usize = 32;
/// Radius of the piece that is missing, px of 120 × 90: about two fingers across.
pub(super) const HOLE_PX: i32 = 8;

/// The same poses twice.
pub(super) struct Unseen {
    pub(super) whole: Described,
    /// One view of each sample, at random, lacks a disc of the hand.
    pub(super) damaged: Described,
    /// Poses left out of both, since what is left of a view cannot be described.
    pub(super) left_out: usize,
}

impl Unseen {
    pub(super) fn draw(lab: &Lab<'_>) -> Result<Self> {
        let frames: Vec<Pose> =
            TAKES.flat_map(|take| complex_take(take).into_iter().step_by(EVERY)).collect();
        let set = DataSet { name: "unseen".to_owned(), poses: at_seven_angles(&frames) };
        let Lab { rig, hand, progress, .. } = lab;
        let mut whole = set.describe(rig, hand, *progress)?;
        progress.begin("damage", whole.poses.len());
        let damaged: Vec<Option<PoseContexts>> = (0..whole.poses.len())
            .into_par_iter()
            .map(|i| {
                let mut contexts = whole.contexts[i].clone();
                let mut random = Pcg64Mcg::seed_from_u64(i as u64);
                let view = (random.next_u64() % contexts.len() as u64) as usize;
                let damaged = damaged(rig, hand, &whole.poses[i], view, &mut random)?;
                progress.step();
                Ok(damaged.map(|damaged| {
                    contexts[view] = damaged;
                    contexts
                }))
            })
            .collect::<Result<_>>()?;
        let (all, mut kept) = (whole.poses.len(), damaged.iter().map(Option::is_some));
        whole.contexts.retain(|_| kept.next().unwrap_or(false));
        kept = damaged.iter().map(Option::is_some);
        whole.poses.retain(|_| kept.next().unwrap_or(false));
        let damaged = Described {
            name: "unseen, one view damaged".to_owned(),
            poses: whole.poses.clone(),
            active: whole.active.clone(),
            contexts: damaged.into_iter().flatten().collect(),
        };
        Ok(Self { left_out: all - whole.poses.len(), whole, damaged })
    }
}

/// The shape contexts of one view with a piece of the hand missing; `None` where what is left
/// is no describable silhouette.
fn damaged(
    rig: &Rig,
    hand: &HandShape,
    pose: &Pose,
    view: usize,
    random: &mut Pcg64Mcg,
) -> Result<Option<Vec<f32>>> {
    let mut mask = draw_silhouette(&rig.cameras[view], hand, pose, &rig.volume.rest_frame())?;
    pierce(&mut mask, random);
    let (mut describer, mut silhouette) = (Describer::default(), Silhouette::default());
    let contexts = match describer.silhouette_of_mask(&mask, &mut silhouette) {
        Ok(()) => describer.contexts(&silhouette, OrientationRule::HandAxis).ok(),
        Err(_) => None,
    };
    Ok(contexts.map(|contexts| contexts.values().to_vec()))
}

/// Takes a disc around a random pixel of the hand out of a mask.
fn pierce(mask: &mut Mask, random: &mut Pcg64Mcg) {
    let hand: Vec<[u32; 2]> = mask.hand_pixels().collect();
    if hand.is_empty() {
        return;
    }
    let [x0, y0] = hand[(random.next_u64() % hand.len() as u64) as usize];
    for [x, y] in hand {
        let (dx, dy) = (x as i32 - x0 as i32, y as i32 - y0 as i32);
        if dx * dx + dy * dy <= HOLE_PX * HOLE_PX {
            mask.put_pixel(x, y, Luma([0]));
        }
    }
}
