//! How a run went.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Result, ensure};
use phalanx_camera::Camera;
use phalanx_hand::HandShape;
use phalanx_io::take::{FrameView, TakeFrame};
use serde::{Deserialize, Serialize};

use crate::counts::{counted, either};
use crate::recording::doubt;

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
}

impl Tally {
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
        out: &Path,
    ) -> Result<ExitCode> {
        let Self { frames, with_hand, doubted, doubts, with_fewer, without, failures, named } =
            self;
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
                 another, are its frames of other moments, or does it not see the hand? `phalanx doctor` looks",
                camera.name,
                counted(*frames, "frame")
            );
        }
        eprintln!(
            "phalanx: {with_hand} of {} {} the hand, {doubted} {} doubted (column `doubts`); the hand is {:.0} mm long; {}",
            counted(*frames, "frame"),
            either(*with_hand, "shows", "show"),
            either(*doubted, "is", "are"),
            hand.length_mm(),
            out.display()
        );
        Ok(if *failures == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }
}
