//! Where the hand works, from frames that each say where it is.

use glam::{DAffine3, DQuat, DVec3};
use phalanx_camera::{Camera, Volume};
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::PoseFitSettings;
use rayon::prelude::*;

use super::frame_fit::{Found, FrameFitter};
use super::misfit::DISAGREEMENT;
use super::observation::{Sight, length_mm};
use super::starts;
use super::take_frame::TakeFrame;
use crate::error::{Error, Result};
use crate::progress::Progress;

/// Frames from which it is found where the hand works.
const KEY_FRAMES: usize = 12;

/// Least side of a working volume, mm.
const LEAST_SIDE: f64 = 20.0;

/// A pose and the frame that it is said in.
pub(super) type Posed = (Pose, DAffine3);

/// Where a hand works, and how far it turns there.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeEstimate {
    /// The volume; its `up` is where the back of the hand points on average.
    pub volume: Volume,
    /// The least and the most of θ_X, θ_Y and θ_Z in it, radians.
    pub turns: [[f64; 2]; 3],
}

/// How frames are fitted while it is not known which views agree: hand and cameras are taken as they
/// are, and starts are many.
pub(super) fn refinement() -> PoseFitSettings {
    PoseFitSettings { disagreement: Some(DISAGREEMENT), ..believing() }
}

/// How frames are fitted when all views that are left agree.
pub(super) fn believing() -> PoseFitSettings {
    let mut settings = PoseFitSettings { max_restarts: 0, ..PoseFitSettings::of_noise(NOISE) };
    // Starts were screened, which is the coarsest level.
    settings.levels.remove(0);
    for level in &mut settings.levels {
        level.every *= SPARSER;
    }
    settings
}

/// Of so many times more places along a border one is looked at than where borders are known to half a pixel:
/// a border that is four times less well known errs together over longer pieces.
const SPARSER: usize = 2;

/// A border that is as far from the hand's as this, in pixels of a crop, begins to count less: a quarter
/// of a finger's width. How well borders are known is found from the take.
const NOISE: f64 = 2.0;

/// Poses of some frames, spread evenly, each found with nothing known.
pub(super) fn key_frames(
    cameras: &[Camera],
    frames: &[TakeFrame],
    fitter: &FrameFitter<'_>,
    progress: &dyn Progress,
) -> Result<Vec<Found>> {
    let chosen = evenly(frames.len(), KEY_FRAMES);
    progress.begin("look for the hand", chosen.len());
    let search = |&k: &usize| {
        let found = fitter.search(&Sight::of(cameras, &frames[k])?);
        progress.step();
        found
    };
    let found: Vec<Option<Found>> = chosen.par_iter().map(search).collect::<Result<_>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// Where hands of some frames agree that the hand is: the frame that half of the others are nearest to.
///
/// # Errors
/// No hand.
pub(super) fn agreed(found: &[Found], hand: &HandShape) -> Result<DAffine3> {
    let frames: Vec<DAffine3> = found.iter().map(|found| found.frame(hand)).collect();
    let reach = 0.5 * length_mm(hand);
    let median = |one: &DAffine3| {
        let mut all: Vec<f64> = frames.iter().map(|other| apart(one, other, reach)).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let best = frames.iter().min_by(|a, b| median(a).total_cmp(&median(b)));
    best.copied().ok_or(Error::NoHand)
}

/// How far one hand's frame is from another's: the angle of its turn, and its way over `reach`, mm.
fn apart(one: &DAffine3, other: &DAffine3, reach: f64) -> f64 {
    let turn = DQuat::from_mat3(&(one.matrix3.transpose() * other.matrix3));
    let angle = 2.0 * turn.w.abs().min(1.0).acos();
    one.translation.distance(other.translation) / reach + angle
}

/// Indices spread evenly over `count`, at most `most`.
pub(super) fn evenly(count: usize, most: usize) -> Vec<usize> {
    let most = most.min(count);
    (0..most).map(|k| (2 * k + 1) * count / (2 * most)).collect()
}

impl VolumeEstimate {
    /// That of some poses around a frame that most of them are near.
    pub(super) fn around<'a>(
        middle: &DAffine3,
        found: impl Iterator<Item = &'a Found>,
        hand: &HandShape,
    ) -> Self {
        let poses: Vec<Posed> = found.map(|found| (found.refined.pose, found.rest)).collect();
        Self::of(middle, &poses, hand)
    }

    /// That of a hand's frame and of poses.
    pub(super) fn of(middle: &DAffine3, poses: &[Posed], hand: &HandShape) -> Self {
        let frames: Vec<DAffine3> =
            poses.iter().map(|(pose, rest)| starts::frame_at(pose, rest, hand)).collect();
        let sum = |axis: fn(&DAffine3) -> DVec3| frames.iter().map(axis).sum::<DVec3>();
        let forearm = sum(|frame| frame.matrix3.z_axis).normalize_or(middle.matrix3.z_axis);
        let up = sum(|frame| frame.matrix3.y_axis);
        let up = up.reject_from_normalized(forearm).normalize_or(middle.matrix3.y_axis);
        let least = Volume { center: DVec3::ZERO, size: DVec3::splat(LEAST_SIDE), forearm, up };
        // Sides are along the volume's own axes.
        let axes = least.rest_frame().matrix3;
        let wrists =
            frames.iter().chain([middle]).map(|frame| axes.transpose() * frame.translation);
        let (low, high) = wrists
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high): (DVec3, DVec3), wrist| {
                (low.min(wrist), high.max(wrist))
            });
        let volume = Volume {
            center: axes * low.midpoint(high),
            size: (high - low).max(least.size),
            ..least
        };
        let rest = volume.rest_frame();
        let turns = [Dof::ThetaX, Dof::ThetaY, Dof::ThetaZ].map(|dof| {
            let angle = |(pose, own): &Posed| starts::in_frame(pose, own, &rest, hand)[dof];
            let angles = poses.iter().map(angle);
            angles.fold([0.0; 2], |[low, high]: [f64; 2], angle| [low.min(angle), high.max(angle)])
        });
        Self { volume, turns }
    }
}
