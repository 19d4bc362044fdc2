//! A long recording: some moments tell the hand, which is then tracked from frame to frame.

use anyhow::{Context, Result};
use phalanx::{Delay, Progress, TakeSettings, Tracker};
use phalanx_cli::files::Output;
use phalanx_hand::HandShape;

use super::conclusion::Tally;
use super::journal::{Journal, Point};
use super::recorded::Recorded;
use super::rows::{Kind, Rows, Written};
use crate::progress::Bar;

/// A run, and where it is.
pub(super) struct Streaming<'a> {
    recorded: Recorded<'a>,
    pub(super) hand: HandShape,
    tracker: Tracker,
    rows: Rows,
    /// The moment that is read next.
    next: usize,
}

impl<'a> Streaming<'a> {
    /// Fits the hand to some moments.
    pub(super) fn begun(
        mut recorded: Recorded<'a>,
        (most, settings): (usize, &TakeSettings),
        (out, kind): (&Output, Kind),
        bar: &Bar,
    ) -> Result<Self> {
        // Every picture is read once more on the way.
        let fit = recorded.fit(most, settings, bar, &mut Vec::new())?;
        recorded.reader.rewind()?;
        let tracker = Tracker::of_take(&recorded.source.cameras, &fit, Delay::OneFrame)?;
        let header = recorded.header(&fit.hand, fit.volume.volume.rest_frame());
        let rows = Rows::new(out, kind, header, None, Tally::of_fit(&fit, settings))?;
        Ok(Self { recorded, hand: fit.hand, tracker, rows, next: 0 })
    }

    /// What was counted so far.
    pub(super) fn tally(&self) -> &Tally {
        &self.rows.tally
    }

    /// Goes on where an earlier run was.
    pub(super) fn resumed(
        mut recorded: Recorded<'a>,
        point: Point,
        (out, kind): (&Output, Kind),
    ) -> Result<Self> {
        let Point { hand, tracker, moment, bytes, tally } = point;
        let mut tracker = Tracker::resumed(&recorded.source.cameras, tracker)?;
        let rest = tracker.world_from_hand().context("the hand's place is known")?;
        // Before the first row there is only the header, which is written again.
        let last = moment.checked_sub(1);
        let last = last.map(|last| (last as u64, recorded.times()[last]));
        let written = last.map(|last| Written { bytes, last });
        let header = recorded.header(&hand, rest);
        let rows = Rows::new(out, kind, header, written.as_ref(), tally)?;
        let frame = recorded.reader.read_noting(moment, &mut Vec::new());
        tracker.push(&frame)?;
        Ok(Self { recorded, hand, tracker, rows, next: moment + 1 })
    }

    /// Tracks the hand to the end, and makes the rows the output.
    pub(super) fn run(self, journal: &mut Journal, bar: &Bar) -> Result<Tally> {
        let Self { mut recorded, hand, mut tracker, mut rows, next } = self;
        let count = recorded.times().len();
        bar.begin("track the hand", count - next);
        for moment in next..count {
            let state = tracker.state().context("the hand is known")?;
            let mut failures = Vec::new();
            let frame = recorded.reader.read_noting(moment, &mut failures);
            rows.tally.add_failures(failures);
            if let Some(due) = tracker.push(&frame)? {
                rows.push(&recorded.frame(moment - 1, due.fit.as_ref()))?;
            }
            journal.keep(|| {
                let (hand, tally, bytes) = (hand.clone(), rows.tally.clone(), rows.secured()?);
                Ok(Point { hand, tracker: state, moment, bytes, tally })
            });
            bar.step();
        }
        if let Some(due) = tracker.finish()? {
            rows.push(&recorded.frame(count - 1, due.fit.as_ref()))?;
        }
        rows.finish()
    }
}
