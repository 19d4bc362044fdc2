//! A recording that is being tracked: its cameras, moments and times.

use anyhow::{Result, bail};
use glam::DAffine3;
use phalanx::{FrameFit, TakeFit, TakeSettings, fit_take};
use phalanx_hand::HandShape;
use phalanx_io::take::{TakeFrame, TakeHeader};

use super::arguments::LEAST_TOGETHER;
use super::take;
use crate::counts::counted;
use crate::progress::Bar;
use crate::recording::reader::Reader;
use crate::recording::source::Source;
use crate::recording::timeline::Timeline;

pub(super) struct Recorded<'a> {
    pub(super) source: &'a Source,
    pub(super) reader: Reader<'a>,
}

impl<'a> Recorded<'a> {
    /// Opens a recording; `rate` is that of pictures without times, Hz.
    pub(super) fn open(source: &'a Source, rate: Option<f64>) -> Result<Self> {
        let reader = source.reader()?;
        let reader = match rate {
            Some(rate) => reader.with_rate(rate),
            None => reader,
        };
        Ok(Self { source, reader })
    }

    /// When each moment was, s.
    pub(super) fn times(&self) -> &[f64] {
        &self.reader.times
    }

    /// Fits some moments from everywhere together; what cannot be read is noted.
    pub(super) fn fit(
        &mut self,
        most: usize,
        settings: &TakeSettings,
        bar: &Bar,
        failures: &mut Vec<String>,
    ) -> Result<TakeFit> {
        let frames = self.reader.read_some(most, failures);
        let is_empty = |frame: &phalanx::TakeFrame| {
            frame.masks.iter().all(Option::is_none) && frame.landmarks.iter().all(Option::is_none)
        };
        if let (Some(first), true) = (failures.first(), frames.iter().all(is_empty)) {
            bail!("none of the {} can be used; {first}", counted(failures.len(), "picture"));
        }
        Ok(fit_take(&self.source.cameras, &frames, settings, bar)?)
    }

    /// What is said of all frames.
    pub(super) fn header(&self, hand: &HandShape, rest: DAffine3) -> TakeHeader {
        take::header(&self.source.cameras, (hand, rest), self.reader.rate)
    }

    /// What is said of a moment.
    pub(super) fn frame(&self, moment: usize, fit: Option<&FrameFit>) -> TakeFrame {
        let Self { source, reader } = self;
        let shown = reader.shown(moment);
        take::frame(&source.cameras, (moment, &shown), reader.times[moment], fit)
    }

    /// Says what was found. `rate` is the one that was given.
    pub(super) fn tell(&self, rate: Option<f64>) {
        let (cameras, timeline) = (&self.source.cameras, &self.reader.timeline);
        let Timeline { moments, missing, unmatched } = timeline;
        let moments = counted(moments.len(), "moment");
        eprintln!("phalanx: {moments} by {}", counted(cameras.len(), "camera"));
        if self.times().len() < LEAST_TOGETHER {
            eprintln!(
                "phalanx: with fewer than {LEAST_TOGETHER} moments the hand's proportions are uncertain"
            );
        }
        if let (Some(assumed), None) = (self.reader.rate, rate) {
            eprintln!(
                "phalanx: the recording does not say when its pictures were taken: {assumed} a second are assumed; \
                 give --rate or --timestamps"
            );
        }
        for (camera, (&missing, &unmatched)) in cameras.iter().zip(missing.iter().zip(unmatched)) {
            if missing > 0 {
                let missing = counted(missing, "moment");
                eprintln!("phalanx: camera '{}' has no picture at {missing}", camera.name);
            }
            if unmatched > 0 {
                let unmatched = counted(unmatched, "picture");
                eprintln!(
                    "phalanx: camera '{}': {unmatched} belong to no moment of the others and are left out",
                    camera.name
                );
            }
        }
    }
}
