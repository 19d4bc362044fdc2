//! A recording as the tracker follows it, beside the truth.

use anyhow::{Context, Result};
use glam::DVec3;
use phalanx::{Delay, Proportions, TakeFrame, TrackSettings, TrackedFrame, Tracker};
use phalanx_hand::{Digit, Dof, Pose};

use super::drawn::Studio;

/// A recording that was followed.
pub(super) struct Followed {
    truth: Vec<Pose>,
    poses: Vec<Pose>,
    std: Vec<[f64; Dof::COUNT]>,
    /// The joints' mean offsets from the truth, mm.
    offsets: Vec<Vec<DVec3>>,
}

/// The angles of the fingers' joints, which move.
pub(super) fn angles() -> Vec<Dof> {
    Digit::FINGERS.into_iter().flat_map(|digit| digit.dofs().into_iter().skip(1)).collect()
}

impl Followed {
    /// Of frames that show these poses, the hand being known.
    pub(super) fn of(
        studio: &Studio,
        truth: &[Pose],
        frames: &[TakeFrame],
        delay: Delay,
    ) -> Result<Self> {
        let hand = studio.hand.clone();
        let settings = TrackSettings { hand, proportions: Proportions::Given, delay };
        let mut tracker = Tracker::new(&studio.cameras, &settings)?;
        let mut tracked: Vec<TrackedFrame> = Vec::with_capacity(frames.len());
        for frame in frames {
            tracked.extend(tracker.push(frame)?);
        }
        tracked.extend(tracker.finish()?);
        let mut followed =
            Self { truth: truth.to_vec(), poses: vec![], std: vec![], offsets: vec![] };
        for (frame, truth) in tracked.into_iter().zip(truth) {
            let fit = frame.fit.context("a frame without a hand")?;
            let joints = studio.joints(truth);
            followed.offsets.push(fit.joints.iter().zip(joints).map(|(a, b)| *a - b).collect());
            followed.poses.push(fit.pose);
            followed.std.push(fit.std);
        }
        Ok(followed)
    }

    /// Changes of every angle from frame to frame, radians, from a frame on.
    pub(super) fn changes(&self, from: usize) -> Vec<f64> {
        let pairs = self.poses[from..].windows(2);
        let change = |pair: &[Pose]| {
            angles().into_iter().map(|dof| (pair[1][dof] - pair[0][dof]).abs()).collect::<Vec<_>>()
        };
        pairs.flat_map(change).collect()
    }

    /// The deviations of every angle, radians, from a frame on.
    pub(super) fn deviations(&self, from: usize) -> Vec<f64> {
        let of = |std: &[f64; Dof::COUNT]| {
            angles().into_iter().map(|dof| std[dof.index()]).collect::<Vec<_>>()
        };
        self.std[from..].iter().flat_map(of).collect()
    }

    /// Errors of every angle, radians, from a frame on.
    pub(super) fn errors(&self, from: usize) -> Vec<f64> {
        let pairs = self.poses.iter().zip(&self.truth).skip(from);
        pairs
            .flat_map(|(pose, truth)| {
                angles().into_iter().map(|dof| (pose[dof] - truth[dof]).abs())
            })
            .collect()
    }

    /// How far joints jump from one frame to the next beside the truth, mm, a mean over the joints; one number
    /// for each frame but the first.
    pub(super) fn jumps(&self) -> Vec<f64> {
        let jump = |pair: &[Vec<DVec3>]| {
            let sum: f64 = pair[0].iter().zip(&pair[1]).map(|(a, b)| a.distance(*b)).sum();
            sum / pair[0].len() as f64
        };
        self.offsets.windows(2).map(jump).collect()
    }

    /// By how many frames answers are behind the truth that they are about, a share of a frame being told from
    /// the parabola through the greatest correlation of the angles' changes and its neighbours.
    pub(super) fn lag_frames(&self, from: usize) -> f64 {
        let correlations: Vec<f64> =
            (-MOST..=MOST).map(|lag| self.correlation(from, lag)).collect();
        let inner = 1..correlations.len() - 1;
        let Some(best) = inner.max_by(|&a, &b| correlations[a].total_cmp(&correlations[b])) else {
            return f64::NAN;
        };
        let [before, at, after] =
            [-1, 0, 1].map(|step| correlations[best.saturating_add_signed(step)]);
        let vertex = 0.5 * (before - after) / (before - 2.0 * at + after);
        best as f64 - MOST as f64 + vertex
    }

    /// The correlation of the answers' changes with the truth's so many frames earlier.
    fn correlation(&self, from: usize, lag: isize) -> f64 {
        let change =
            |poses: &[Pose], number: usize, dof: Dof| poses[number + 1][dof] - poses[number][dof];
        let (mut product, mut squares) = (0.0, [0.0; 2]);
        for number in from..self.poses.len() - 1 - MOST as usize {
            for dof in angles() {
                let found = change(&self.poses, number, dof);
                let truth = change(&self.truth, number.saturating_add_signed(-lag), dof);
                product += found * truth;
                squares[0] += found * found;
                squares[1] += truth * truth;
            }
        }
        product / (squares[0] * squares[1]).sqrt()
    }
}

/// Lags are looked for up to so many frames.
const MOST: isize = 4;
