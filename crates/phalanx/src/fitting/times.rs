//! When the frames of a take were seen.

use super::take_frame::TakeFrame;
use crate::error::{Error, Result};

/// What times are rounded to, in usual steps, a power of two: an even pace is then exactly even.
const EXACT: f64 = 1.0 / 1_048_576.0;

/// The times of a take's frames, of which one follows the other at a usual pace: the median of their distances is 1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Times(Vec<f64>);

impl Times {
    /// Those of frames; of frames without times, as if one followed the other at one pace.
    ///
    /// # Errors
    /// A time of some frames only, or one that is not after that of the frame before.
    pub(super) fn of(frames: &[TakeFrame]) -> Result<Self> {
        let known = frames.iter().filter(|frame| frame.seconds.is_some()).count();
        if known == 0 {
            return Ok(Self::even(frames.len()));
        }
        let time = |(frame, seen): (usize, &TakeFrame)| {
            seen.seconds.ok_or(Error::NoFrameTime { frame: Some(frame) })
        };
        Self::from_seconds(&frames.iter().enumerate().map(time).collect::<Result<Vec<_>>>()?)
    }

    /// Of so many frames at one pace.
    pub(super) fn even(count: usize) -> Self {
        Self((0..count).map(|k| k as f64).collect())
    }

    fn from_seconds(seconds: &[f64]) -> Result<Self> {
        let mut steps: Vec<f64> = seconds.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if let Some(k) = steps.iter().position(|step| !(*step > 0.0 && step.is_finite())) {
            return Err(Error::FrameTime { time: seconds[k + 1], before: seconds[k] });
        }
        steps.sort_by(f64::total_cmp);
        let pace = steps.get(steps.len() / 2).copied().unwrap_or(1.0);
        let first = seconds.first().copied().unwrap_or(0.0);
        let rounded = |time: &f64| ((time - first) / pace / EXACT).round() * EXACT;
        Ok(Self(seconds.iter().map(rounded).collect()))
    }

    /// How far two frames are from each other: never nothing, which motions are divided by.
    pub(super) fn between(&self, one: usize, other: usize) -> f64 {
        (self.0[one] - self.0[other]).abs().max(EXACT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(seconds: &[Option<f64>]) -> Result<Times> {
        let frame = |&seconds: &Option<f64>| TakeFrame { seconds, ..TakeFrame::default() };
        Times::of(&seconds.iter().map(frame).collect::<Vec<_>>())
    }

    #[test]
    fn a_gap_is_as_long_as_it_was() {
        let times = of(&[7.0, 7.5, 8.0, 11.0, 11.5].map(Some)).unwrap();
        assert_eq!(
            [times.between(0, 1), times.between(3, 2), times.between(0, 4)],
            [1.0, 6.0, 9.0]
        );
        assert_eq!(of(&[None; 3]).unwrap(), Times::even(3));
        let even: Vec<Option<f64>> = (7..207).map(|k| Some(f64::from(k) / 30.0)).collect();
        assert_eq!(of(&even).unwrap(), Times::even(200));
        let close = of(&[0.0, 1.0, 1.0 + 1e-9, 2.0].map(Some)).unwrap();
        assert!(close.between(1, 2) > 0.0);
        assert_eq!(of(&[]).unwrap(), Times::even(0));
    }

    #[test]
    fn times_are_in_order_and_of_all_frames() {
        for wrong in [[0.0, 1.0, 1.0], [0.0, 2.0, 1.0], [0.0, f64::NAN, 1.0]] {
            let error = of(&wrong.map(Some)).unwrap_err();
            assert!(matches!(error, Error::FrameTime { .. }), "{error}");
        }
        let error = of(&[Some(0.0), None]).unwrap_err();
        assert!(matches!(error, Error::NoFrameTime { frame: Some(1) }), "{error}");
    }
}
