//! What is kept of a tracker, so that another goes on where it was.

use glam::DAffine3;
use serde::{Deserialize, Serialize};

use super::delay::Delay;
use super::motion::Motion;
use super::noise::MotionNoise;
use super::recent::Recent;
use crate::fitting::known::Known;

/// What a [`Tracker`](super::Tracker) knows after a frame, some 30 kB as bytes: all that its later answers depend
/// on but what that frame showed.
///
/// ```no_run
/// use phalanx::{Tracker, TrackerState};
/// # fn go_on(cameras: &[phalanx_camera::Camera], kept: TrackerState, last: &phalanx::TakeFrame,
/// #     next: &phalanx::TakeFrame) -> phalanx::Result<()> {
/// // `kept` is the state before the frame at 1.0 s.
/// let mut tracker = Tracker::resumed(cameras, kept)?;
/// // The frame before was answered by the tracker that it is the state of.
/// assert_eq!(tracker.push(last)?, None);
/// let answer = tracker.push(next)?.expect("the frame at 1.0 s");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TrackerState {
    pub(super) delay: Delay,
    pub(super) known: Known,
    pub(super) rest: Option<DAffine3>,
    pub(super) noise: MotionNoise,
    pub(super) recent: Recent,
    /// When the last frame was, and the motion after it.
    pub(super) last: Option<(f64, Option<Motion>)>,
}
