//! How a run went.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Result, ensure};
use phalanx::{Proportions, TakeFit, TakeSettings};
use phalanx_camera::Camera;
use phalanx_hand::HandShape;
use phalanx_io::take::{FrameView, TakeFrame};
use serde::{Deserialize, Serialize};

use crate::counts::{counted, either};
use crate::recording::doubt;
use crate::side::SideName;

/// So many of the pictures that could not be read are named.
const NAMED: usize = 20;

/// Counts of frames.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Tally {
    frames: usize,
    with_hand: usize,
    doubted: usize,
    /// What any was doubted for.
    doubts: BTreeSet<String>,
    /// Without one of the views or more, and without each of them.
    with_fewer: usize,
    without: Vec<usize>,
    failures: usize,
    named: Vec<String>,
    /// Whether the recording was to tell the hand's proportions, and did not.
    pub(super) hand_not_told: bool,
    /// Whether it may be a hand of the other side as well.
    side_not_told: bool,
}

impl Tally {
    /// Of a fit before any of its frames is counted.
    pub(super) fn of_fit(fit: &TakeFit, settings: &TakeSettings) -> Self {
        let is_asked = settings.proportions == Proportions::FromTake;
        Self {
            hand_not_told: is_asked && !fit.is_hand_learnt(),
            side_not_told: !fit.tells_side(),
            ..Self::default()
        }
    }

    /// Counts a frame.
    pub(super) fn add(&mut self, frame: &TakeFrame) {
        self.frames += 1;
        self.with_hand += usize::from(frame.estimate.is_some());
        self.doubted += usize::from(!frame.doubts.is_empty());
        self.doubts.extend(frame.doubts.iter().cloned());
        let is_left_out = |view: &FrameView| view.left_out.is_some();
        self.with_fewer += usize::from(frame.views.iter().any(is_left_out));
        self.without.resize(frame.views.len(), 0);
        for (without, view) in self.without.iter_mut().zip(&frame.views) {
            *without += usize::from(is_left_out(view));
        }
    }

    /// Counts pictures that could not be read, each in words.
    pub(super) fn add_failures(&mut self, failures: Vec<String>) {
        self.failures += failures.len();
        let room = NAMED - self.named.len();
        self.named.extend(failures.into_iter().take(room));
    }

    /// Says how it went, of a take that is written; pictures that could not be read make another exit code.
    pub(super) fn conclude(
        &self,
        cameras: &[Camera],
        hand: &HandShape,
        said_side: Option<SideName>,
        out: &Path,
    ) -> Result<ExitCode> {
        let Self {
            frames, with_hand, doubted, doubts, with_fewer, without, failures, named, ..
        } = self;
        for failure in named {
            eprintln!("phalanx: {failure}");
        }
        if *failures > named.len() {
            eprintln!("phalanx: and {} more", failures - named.len());
        }
        ensure!(*with_hand > 0, "no frame shows a hand");
        let remedy = doubts.iter().find_map(|code| doubt::remedy(code, hand.side));
        if let Some(remedy) = &remedy {
            eprintln!("phalanx: {remedy}");
        } else if self.side_not_told && said_side.is_none() {
            let side = SideName::from(hand.side);
            eprintln!(
                "phalanx: the recording hardly tells a right hand from a left one: a {side} one was fitted; say which with --side"
            );
        }
        if *with_fewer > 0 {
            let fewer = counted(*with_fewer, "frame");
            eprintln!("phalanx: in {fewer} a view was left out (column `left_out`)");
        }
        // A right camera may be left out for the sake of those that are exchanged.
        let is_left_out = |&(_, &without): &(_, &usize)| remedy.is_none() && 2 * without > *frames;
        for (camera, &without) in cameras.iter().zip(without).filter(is_left_out) {
            eprintln!(
                "phalanx: camera '{}' was left out of {without} of {}: was it moved or exchanged with \
                 another, are its frames of other moments, is the rig's unit wrong, or does it not see the hand? \
                 `phalanx doctor` looks",
                camera.name,
                counted(*frames, "frame")
            );
        }
        if remedy.is_none() && 2 * doubted > *with_hand {
            eprintln!(
                "phalanx: most frames are doubted: `phalanx doctor` looks for the cause, and `phalanx view` shows what was fitted"
            );
        }
        let length = hand.length_mm();
        let hand = if self.hand_not_told {
            format!(
                "the recording does not tell the hand's proportions: a mean hand of {length:.0} mm was fitted"
            )
        } else {
            format!("the hand is {length:.0} mm long")
        };
        eprintln!(
            "phalanx: {with_hand} of {} {} the hand, {doubted} {} doubted (column `doubts`); {hand}; {}",
            counted(*frames, "frame"),
            either(*with_hand, "shows", "show"),
            either(*doubted, "is", "are"),
            out.display()
        );
        Ok(if *failures == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }
}
