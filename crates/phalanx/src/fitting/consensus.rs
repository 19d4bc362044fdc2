//! Where the hand works, from frames that each say where it is.

use glam::{DAffine3, DQuat, DVec3};
use phalanx_camera::{Camera, Volume};
use phalanx_hand::{Dof, HandShape, Pose};
use phalanx_refine::{DrawnTerm, PoseFitSettings};
use rayon::prelude::*;

use super::found::Found;
use super::frame_fit::FrameFitter;
use super::misfit::DISAGREEMENT;
use super::observation::Sight;
use super::search;
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
pub(super) fn searching(cameras: usize) -> PoseFitSettings {
    // Outlines that lie outside what is seen all around cost next to nothing: the mask may be too small. Where only one
    // camera looks, nothing else says that the hand is further away.
    let drawn = if cameras > 1 { DrawnTerm::Outline } else { DrawnTerm::Area };
    PoseFitSettings { drawn, ..near() }
}

/// How frames are fitted again, near where their hands are, while views may still disagree.
pub(super) fn near() -> PoseFitSettings {
    PoseFitSettings { disagreement: Some(DISAGREEMENT), ..believing() }
}

/// How frames are fitted when all views that are left agree: by areas between silhouettes.
pub(super) fn believing() -> PoseFitSettings {
    let mut settings = PoseFitSettings {
        max_restarts: 0,
        settling_steps: 0,
        drawn: DrawnTerm::Area,
        ..PoseFitSettings::of_noise(NOISE)
    };
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
        let found = search::anywhere(fitter, &Sight::of(cameras, &frames[k])?);
        progress.step();
        found
    };
    let found: Vec<Option<Found>> = chosen.par_iter().map(search).collect::<Result<_>>()?;
    Ok(found.into_iter().flatten().collect())
}

/// One frame in so many that shows the hand's palm where most show its back is enough to doubt most.
const DISPUTED: usize = 4;

/// Where hands of some frames agree that the hand is; also where those are that show its other side, if they are
/// many: silhouettes of cameras that look at it from opposite sides hardly tell its palm from its back. A hand that turns
/// over in the take has both, too.
///
/// # Errors
/// No hand.
pub(super) fn agreed(frames: &[DAffine3], hand: &HandShape) -> Result<Vec<DAffine3>> {
    let reach = 0.5 * hand.length_mm();
    let most = central(frames, reach).ok_or(Error::NoHand)?;
    let back = most.matrix3.y_axis;
    let opposed: Vec<DAffine3> =
        frames.iter().copied().filter(|frame| frame.matrix3.y_axis.dot(back) < 0.0).collect();
    let is_disputed = DISPUTED * opposed.len() >= frames.len();
    let other = if is_disputed { central(&opposed, reach) } else { None };
    Ok(std::iter::once(most).chain(other).collect())
}

/// The frame that half of the others are nearest to.
fn central(frames: &[DAffine3], reach: f64) -> Option<DAffine3> {
    let median = |one: &DAffine3| {
        let mut all: Vec<f64> = frames.iter().map(|other| apart(one, other, reach)).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    frames.iter().min_by(|a, b| median(a).total_cmp(&median(b))).copied()
}

/// How far one hand's frame is from another's: the angle of its turn, and its way over `reach`, mm.
pub(super) fn apart(one: &DAffine3, other: &DAffine3, reach: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;

    #[test]
    fn another_side_is_asked_about_where_many_frames_show_it() {
        let hand = HandShape::adult();
        let turned = |k: usize, turn: f64| {
            let turn = DMat3::from_rotation_z(turn + 0.05 * k as f64);
            DAffine3::from_mat3_translation(turn, DVec3::X * k as f64)
        };
        let frames = |opposed: usize| -> Vec<DAffine3> {
            let side = |k: usize| if k < opposed { std::f64::consts::PI } else { 0.0 };
            (0..12).map(|k| turned(k, side(k))).collect()
        };
        let up = |frame: &DAffine3| frame.matrix3.y_axis.y > 0.0;
        let sides = |opposed: usize| -> Vec<bool> {
            agreed(&frames(opposed), &hand).unwrap().iter().map(up).collect()
        };
        assert_eq!(sides(0), [true]);
        assert_eq!(sides(2), [true]);
        assert_eq!(sides(3), [true, false]);
        assert_eq!(sides(9), [false, true]);
        assert!(agreed(&[], &hand).is_err());
    }
}
