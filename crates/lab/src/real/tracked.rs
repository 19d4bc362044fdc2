//! Takes tracked frame by frame: `tracked`, as `phalanx track` does, with the hand that the take told, and
//! `live`, the hand learnt on the way.

use anyhow::{Context, Result, anyhow};
use phalanx::{Delay, Progress, TrackSettings, TrackedFrame, Tracker};
use phalanx_hand::HandShape;

use super::method::{Method, Outcome, Sequence};
use super::whole_take::{Fits, found};
use crate::clock::timed;

/// Which hand is tracked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    /// That of the take, from all its frames.
    OfTake,
    /// A mean one, whose proportions are learnt on the way.
    Anyone,
}

/// `phalanx::Tracker`.
pub struct Tracked<'a> {
    /// The fits that tell the hand.
    pub fits: &'a Fits,
    /// Which hand is tracked.
    pub whose: Whose,
}

impl Method for Tracked<'_> {
    fn name(&self) -> &'static str {
        match self.whose {
            Whose::OfTake => "tracked",
            Whose::Anyone => "live",
        }
    }

    fn run(&self, sequence: &Sequence<'_>, progress: &dyn Progress) -> Result<Vec<Outcome>> {
        let cameras = sequence.cameras();
        let mut tracker = match self.whose {
            Whose::OfTake => {
                let take = self.fits.take(sequence, progress)?;
                let take = take.as_ref().map_err(|error| anyhow!("{error}"))?;
                Tracker::of_take(&cameras, take, Delay::OneFrame)?
            }
            Whose::Anyone => {
                let hand = HandShape { side: sequence.take.side, ..HandShape::adult() };
                Tracker::new(&cameras, &TrackSettings { hand, ..TrackSettings::default() })?
            }
        };
        let (mut tracked, mut times) = (Vec::new(), Vec::new());
        for number in 0..sequence.frames.len() {
            let frame = self.fits.frame_of(sequence, number)?;
            let (seconds, due) = timed(|| tracker.push(&frame))?;
            tracked.extend(due);
            times.push(1e3 * seconds);
            progress.step();
        }
        let rest = tracker.world_from_hand();
        let hand = tracker.hand().clone();
        tracked.extend(tracker.finish()?);
        let outcome = |(TrackedFrame { fit, .. }, ms): (TrackedFrame, f64)| {
            let fit = fit.zip(rest).context("no hand was seen yet");
            Outcome {
                found: fit.map(|(fit, rest)| found(&cameras, &hand, &rest, &fit)),
                cpu_ms: Some(ms),
            }
        };
        Ok(tracked.into_iter().zip(times).map(outcome).collect())
    }
}
