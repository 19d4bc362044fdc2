//! The options of `phalanx track`.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
use clap::Args;
use phalanx::{Proportions, TakeSettings};
use phalanx_hand::{HandShape, Side};

use super::rows::Kind;
use crate::recording::source::RecordingArguments;
use crate::side::SideName;
use crate::{input, take_file};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(super) recording: RecordingArguments,
    /// The cameras, as `phalanx rig import` writes them.
    #[arg(long, value_name = "FILE.toml")]
    pub(super) rig: PathBuf,
    /// The person's hand, as `calibrate-hand` or `--save-hand` writes it; fitted on the way by default.
    #[arg(long, value_name = "FILE.toml")]
    pub(super) hand: Option<PathBuf>,
    /// Which hand it is; a right one unless it is said.
    #[arg(long, value_enum)]
    pub(super) side: Option<SideName>,
    /// The frame rate of pictures that have no times; 30 Hz by default.
    #[arg(long, value_name = "HZ", value_parser = rate)]
    pub(super) rate: Option<f64>,
    /// A recording of up to so many moments is fitted as a whole. Of a longer one as many, drawn from all of it, tell
    /// the hand, which is then tracked from frame to frame. At least 6: fewer tell no hand.
    #[arg(long, value_name = "MOMENTS", default_value = "240", value_parser = together)]
    pub(super) fit_together: usize,
    /// Fit all moments together, each in the light of all others, however many there are: takes memory and
    /// some twenty times as long as tracking, and begins anew if it is broken off.
    #[arg(long, conflicts_with = "fit_together")]
    pub(super) whole_take: bool,
    /// Where the angles go: .csv, .jsonl or .npz by its name, or - for CSV on standard output. While a hand is
    /// tracked the frames are in OUT.unfinished; a run that was broken off goes on after them, with what is in
    /// OUT.checkpoint, if it is started again. Before the hand is known, which takes as long as the fit of
    /// --fit-together moments, nothing is kept.
    #[arg(long, value_name = "FILE")]
    pub(super) out: PathBuf,
    /// Write the hand that was fitted, for later recordings of the same person; not if the recording did not tell its
    /// proportions.
    #[arg(long, value_name = "FILE.toml")]
    pub(super) save_hand: Option<PathBuf>,
}

/// Of fewer moments a wrong camera is not told from the others, and half of them are too few to learn proportions from that
/// are tried on the other half: one moment gave a hand of 184 mm where all gave 192.
pub(super) const LEAST_TOGETHER: usize = 6;

fn together(text: &str) -> Result<usize> {
    let moments = text.parse()?;
    ensure!(
        moments >= LEAST_TOGETHER,
        "at least {LEAST_TOGETHER} moments tell a hand: its proportions are learnt from half of them and tried on the \
         other half; leave the option out, or give 24 if time is short"
    );
    Ok(moments)
}

fn rate(text: &str) -> Result<f64> {
    let rate: f64 = text.parse()?;
    ensure!(rate > 0.0 && rate.is_finite(), "expected a number of frames a second, over 0");
    Ok(rate)
}

impl Arguments {
    /// What the output's name says that it is to be.
    pub(super) fn kind(&self) -> Result<Kind> {
        let out = &self.out;
        if out == Path::new("-") {
            return Ok(Kind::Csv);
        }
        match take_file::extension(out).as_str() {
            "csv" => Ok(Kind::Csv),
            "jsonl" => Ok(Kind::JsonLines),
            "npz" => Ok(Kind::Npz),
            _ => bail!(
                "{}: the name must end with .csv, .jsonl or .npz; `phalanx convert` writes other formats",
                out.display()
            ),
        }
    }

    /// Which hand it is.
    pub(super) fn side(&self) -> Side {
        self.side.unwrap_or_default().into()
    }

    /// Which hand it is, if it was said: a hand's file says it too.
    pub(super) fn said_side(&self) -> Option<SideName> {
        self.side.or_else(|| self.hand.as_ref().map(|_| self.side().into()))
    }

    /// The hand to begin with.
    pub(super) fn settings(&self) -> Result<TakeSettings> {
        let side = self.side();
        let Some(path) = &self.hand else {
            let hand = HandShape { side, ..HandShape::adult() };
            return Ok(TakeSettings { hand, proportions: Proportions::FromTake });
        };
        let hand = input::hand(path)?;
        ensure!(hand.side == side, "{}: it is the other hand; see --side", path.display());
        Ok(TakeSettings { hand, proportions: Proportions::Given })
    }

    /// How many moments are fitted together at most.
    pub(super) fn fitted_together(&self) -> usize {
        if self.whole_take { usize::MAX } else { self.fit_together }
    }
}
