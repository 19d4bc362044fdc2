//! `cargo xtask eval-tracking`: how still the tracker keeps a still hand, how far it lags behind a fast one, and
//! how it stands a camera that goes and comes; writes docs/results/tracking.md.

mod drawn;
mod followed;

use anyhow::Result;
use clap::Args;
use comfy_table::{Table, presets};
use phalanx::{Delay, TakeFrame};
use phalanx_hand::Pose;
use rayon::prelude::*;

use crate::clock::median;
use crate::files;
use crate::page::Page;
use drawn::{RATE, Studio, closing};
use followed::Followed;

/// Frames before which the tracker is still finding out what a hand does.
const SETTLED: usize = 15;
/// Frames of the fast motion: three of its periods.
const MOVING: usize = 105;
/// Frames of a posture that is held.
const HELD: usize = 45;
/// Postures that are held, from the motion.
const POSTURES: usize = 8;
/// Degrees a second of the fastest joints: as fast as fingers are moved on purpose, and at leisure.
const FAST_DEG: f64 = 300.0;
const SLOW_DEG: f64 = 60.0;
/// Frames in which a camera is lost, of so many.
const LOST: std::ops::Range<usize> = 40..70;
const WITH_LOSS: usize = 100;

const DELAYS: [(Delay, &str, f64); 2] =
    [(Delay::None, "none", 0.0), (Delay::OneFrame, "one frame", 1.0)];

#[derive(Args)]
pub struct Arguments {}

/// Writes the page and prints it.
pub(crate) fn run(_: &Arguments) -> Result<()> {
    let (rig, hand) = (files::rig(None)?, files::hand(None)?);
    let studio = Studio::new(&rig, &hand);
    let (still, moving) = (still_and_moving(&studio)?, cameras_lost(&studio)?);
    let body = format!(
        "{INTRODUCTION}\n\n## A still hand, and a fast one\n\n{still}\n\n{OF_LAG}\n\n## A camera that goes and comes\n\n{moving}\n"
    );
    let command = "cargo xtask eval-tracking";
    Page { file: "tracking.md", command, title: "Jitter, lag and lost cameras" }.publish(&body)
}

const INTRODUCTION: &str = "Drawn photographs of a known hand by the desk's three cameras, 320×240 at 30 frames a second, with a sensor's noise\n\
    that is another in every frame, cut out by the built-in skin model and tracked as `phalanx track` does. The\n\
    fingers close and open one after the other; angles are the 12 of the fingers' joints.";

const OF_LAG: &str = "*Still* are 8 postures of the motion, each held for 45 frames: the median change of an angle from one frame to the\n\
    next, and the median deviation that is said. *Fast* is the motion at 300°/s at most: *lag* is how long after the\n\
    hand was so an answer is there that correlates best with it, the delay included, in frames; *error* is the mean,\n\
    beside that of the postures held. The first 15 frames of each run are not counted.";

fn still_and_moving(studio: &Studio) -> Result<Table> {
    let motion = closing(FAST_DEG, MOVING);
    let held: Vec<Vec<Pose>> = (0..POSTURES)
        .map(|k| vec![motion[SETTLED + k * (MOVING - SETTLED) / POSTURES]; HELD])
        .collect();
    let seen = held.iter().map(|poses| studio.frames(poses)).collect::<Result<Vec<_>>>()?;
    let moving = studio.frames(&motion)?;
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header([
        "delay",
        "still: change",
        "deviation",
        "error",
        "fast: error",
        "ratio",
        "lag, frames",
    ]);
    for (delay, name, frames) in DELAYS {
        let pairs: Vec<(&Vec<Pose>, &Vec<TakeFrame>)> = held.iter().zip(&seen).collect();
        let still =
            pairs.into_par_iter().map(|(poses, seen)| Followed::of(studio, poses, seen, delay));
        let still = still.collect::<Result<Vec<_>>>()?;
        let fast = Followed::of(studio, &motion, &moving, delay)?;
        let of_still = |of: fn(&Followed, usize) -> Vec<f64>| -> Vec<f64> {
            still.iter().flat_map(|followed| of(followed, SETTLED)).collect()
        };
        let [error, fast_error] =
            [of_still(Followed::errors), fast.errors(SETTLED)].map(|all| mean(&all));
        table.add_row([
            name.to_owned(),
            degrees(median(of_still(Followed::changes)).unwrap_or(f64::NAN)),
            degrees(median(of_still(Followed::deviations)).unwrap_or(f64::NAN)),
            degrees(error),
            degrees(fast_error),
            format!("{:.2}", fast_error / error),
            format!("{:.2}", fast.lag_frames(SETTLED) + frames),
        ]);
    }
    Ok(table)
}

/// How far joints jump in the frame where each camera goes, and in that where it is back.
fn cameras_lost(studio: &Studio) -> Result<String> {
    let motion = closing(SLOW_DEG, WITH_LOSS);
    let seen = studio.frames(&motion)?;
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header([
        "camera lost",
        "usual",
        "95 % of all",
        "where it goes",
        "where it is back",
    ]);
    let follow = |lost: usize| {
        let mut frames = seen.clone();
        frames[LOST].iter_mut().for_each(|frame| frame.masks[lost] = None);
        Followed::of(studio, &motion, &frames, Delay::OneFrame)
    };
    let all = (0..studio.cameras.len()).into_par_iter().map(follow).collect::<Result<Vec<_>>>()?;
    for (camera, followed) in studio.cameras.iter().zip(all) {
        let jumps = followed.jumps();
        // A frame late, the one before is seen in the light of the loss, too.
        let about = |frame: usize| jumps[frame - 2].max(jumps[frame - 1]);
        let (goes, back) = (about(LOST.start), about(LOST.end));
        let mut usual = jumps[SETTLED..].to_vec();
        usual.sort_by(f64::total_cmp);
        let share = |share: f64| usual[(share * usual.len() as f64) as usize];
        let row = [share(0.5), share(0.95), goes, back].map(|mm| format!("{mm:.2} mm"));
        table.add_row([camera.name.clone()].into_iter().chain(row));
    }
    Ok(format!(
        "The motion at {SLOW_DEG:.0}°/s at most for {:.1} s, one of the cameras lost for {:.1} s of it, answers a frame late. A jump is how\n\
         much further or nearer the joints are from the truth than in the frame before, a mean over the 21; where a\n\
         camera goes or comes, the larger of the two frames' that know of it.\n\n{table}",
        WITH_LOSS as f64 / RATE,
        LOST.len() as f64 / RATE,
    ))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn degrees(angle: f64) -> String {
    format!("{:.2}°", angle.to_degrees())
}
